"""When a pair closes within the step, and whether that is an impact or rest.

As plugin/engine/path/contact_path.cc and rest.h have it.
"""

import warp as wp

from mujoco_impact.warp.memory import Bodies, Pairs, Paths
from mujoco_impact.warp.path import (
    Sight,
    acceleration,
    bend,
    coordinates,
    displacement,
    look,
    look_at,
    to_world,
    velocity,
)

wp.set_module_options({"enable_backward": False})

NEVER = wp.constant(1.0e30)

# of the speeds of the two: closing speeds up to it are rounding
_ROUNDING = wp.constant(5.0e-7)

# of a step: as late as a closing may be noticed that the step before could not see
_LATEST = wp.constant(0.25)

# of the touch: what gets no deeper in the step does not close
_NO_DEEPER = wp.constant(1.0e-6)

_NEWTON_STEPS = wp.constant(20)


@wp.func
def resting_gravity(g: wp.vec3, without: float) -> float:
    """|g| of a world, or `without` where there is none (plugin/engine/path/rest.cc)."""
    gravity = wp.length(g)
    if gravity == 0.0:
        return without
    return gravity


@wp.func
def largest_rest_speed(h: float, pressing_gravity: float) -> float:
    """The largest u_rest of a contact that MuJoCo does not carry: 2 h · 1.5 g."""
    return 3.0 * h * pressing_gravity


@wp.func
def carried_rest_speed(h: float, pressing_gravity: float, gap: float) -> float:
    """u_rest of a contact that MuJoCo carries, for an overlap y: max(3 h g, y / 2h)."""
    return wp.max(largest_rest_speed(h, pressing_gravity), -gap / (2.0 * h))


@wp.func
def rest_speed(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    p: int,
    w: int,
    t: float,
    normal: wp.vec3,
    h: float,
    pressing_gravity: float,
    gap_at_start: float,
) -> float:
    """The speed up to which the pair is at rest: 2 h a, a what presses the two."""
    if gap_at_start <= -pairs.depth[p]:
        return carried_rest_speed(h, pressing_gravity, gap_at_start)
    pressing = float(0.0)
    for side in range(2):
        x = pairs.first[p]
        sign = float(1.0)
        if side == 1:
            x = pairs.second[p]
            sign = -1.0
        moved = displacement(bodies, x, coordinates(paths, x, w, t))
        of_centre = to_world(bodies, x, moved, acceleration(paths, x, w, t))
        of_centre += bend(bodies, x, moved, velocity(paths, x, w, t))
        pressing += sign * wp.dot(normal, of_centre)
    return wp.clamp(2.0 * h * pressing, 0.0, largest_rest_speed(h, pressing_gravity))


@wp.func
def closes(sight: Sight, time: float, touch: float) -> bool:
    """Whether the pair closes; one that overlaps must get deeper within `time`."""
    if -sight.rate <= _ROUNDING * sight.speed:
        return False
    return sight.gap >= -touch or -sight.rate * time > _NO_DEEPER * touch


@wp.func
def nearest_gap(
    bodies: Bodies, pairs: Pairs, paths: Paths, p: int, w: int, begin: float, end: float
) -> float:
    """The smallest gap of two spheres between the two times."""
    # d/dt ½ |D|² = D·D', and its derivative without the slow change of D'
    t = float(begin)
    radii = bodies.radius[pairs.first[p]] + bodies.radius[pairs.second[p]]
    sight = look_at(bodies, pairs, paths, p, w, t)
    for _i in range(2):
        square = wp.dot(sight.relative, sight.relative)
        if square > 0.0:
            t = wp.clamp(t - (sight.gap + radii) * sight.rate / square, begin, end)
            sight = look_at(bodies, pairs, paths, p, w, t)
    return sight.gap


@wp.func
def touching_time(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    p: int,
    w: int,
    start: float,
    at_start: Sight,
    begin: float,
    late: float,
    h: float,
) -> float:
    """When the gap is zero, by Newton's method; where it left the step if it did."""
    t = float(start)
    sight = Sight()
    sight = at_start
    going = bool(True)
    step = int(0)
    while going and step < _NEWTON_STEPS:
        if sight.rate >= 0.0:
            going = False
        else:
            change = -sight.gap / sight.rate
            t += change
            step += 1
            if wp.abs(change) < 1.0e-7 * h or t < begin - late or t > begin + 2.0 * h:
                going = False
            else:
                sight = look_at(bodies, pairs, paths, p, w, t)
    return t


@wp.func
def closing_time(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    p: int,
    w: int,
    h: float,
    pressing_gravity: float,
) -> float:
    """When the pair closes as an impact by the end of the step; NEVER if it does not.

    It may be earlier than the step by a part of it: what closed unnoticed at the end of
    the last one, whose look did not know the acceleration of this.
    """
    first = pairs.first[p]
    second = pairs.second[p]
    touch = pairs.touch[p]
    begin = wp.max(paths.busy[first, w], paths.busy[second, w])
    if begin >= h:
        return NEVER
    late = float(0.0)
    if begin == 0.0:
        late = _LATEST * h
    at_begin = look_at(bodies, pairs, paths, p, w, begin)
    at_end = look_at(bodies, pairs, paths, p, w, h)
    t = float(begin)
    if not closes(at_begin, h - begin, touch):
        # impacts may bend a path on which bodies part into one that closes
        if at_begin.rate < 0.0 or at_end.rate >= 0.0 or at_begin.gap < -touch:
            return NEVER
        t = h
    if at_end.gap >= -touch:
        # two balls that are apart at the end may have flown through each other
        if t == h or pairs.plane[p] == 1:
            return NEVER
        if nearest_gap(bodies, pairs, paths, p, w, begin, h) >= -touch:
            return NEVER
    sight = Sight()
    sight = at_begin
    if t == h:
        sight = at_end
    t = touching_time(bodies, pairs, paths, p, w, t, sight, begin, late, h)
    # an overlap that this speed cannot have made was there before: it closes now
    if t < begin - late:
        t = begin
    t = wp.min(t, h)
    sight = look_at(bodies, pairs, paths, p, w, t)
    still = wp.vec3(0.0)
    at_start = look(
        bodies, pairs, p, paths.q[first, w], still, paths.q[second, w], still
    )
    if -sight.rate <= rest_speed(
        bodies, pairs, paths, p, w, t, sight.normal, h, pressing_gravity, at_start.gap
    ):
        return NEVER
    return t
