"""The first impact of a scene: who takes part, and how fast before and after.

An impact shows in the velocities: they jump. It is over once no body that takes part
changes its velocity by more than gravity and the like would, for `QUIET` steps. That
holds for contacts that are over within a step as for those that last twenty.
"""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.comparing.survey import LONGEST_CONTACT, Survey, rest_speed, step_of
from mujoco_impact.impact_list import Meeting, met
from mujoco_impact.trajectory import Array, Trajectory

QUIET = 3
"""Steps without a jump after which an impact is over."""

JUMP = 2e-3
"""Change of velocity in a step that is a jump, over the closing speed."""

WEIGHTS = 1.5
"""Change of velocity in a step that is none, over what gravity makes of it."""


@dataclasses.dataclass(frozen=True)
class FirstImpact:
    """The first impact of our motion.

    Attributes:
        time: When it begins [s].
        closing_speed: Speed at which the two geoms met [m/s].
        geoms: Ids of the two geoms.
        bodies: Ids of the moving bodies that take part, in the order in which they are
            struck: they, or what hangs on the same free body, are in touch.
        meetings: All the impacts that belong to it.
        before: Number of the last sample before it.
        after: Number of the first sample after it.
    """

    time: float
    closing_speed: float
    geoms: tuple[int, int]
    bodies: tuple[int, ...]
    meetings: tuple[Meeting, ...]
    before: int
    after: int


def find_first_impact(
    model: mujoco.MjModel, motion: Trajectory, seen: Survey, geom_ids: dict[str, int]
) -> FirstImpact | None:
    """Returns the first impact of our motion that is faster than rest, None if none is.

    Args:
        model: The scene without the plugin.
        motion: Our motion.
        seen: What was seen of it.
        geom_ids: Ids of the geoms by the names that impacts call them.
    """
    found = met(motion.impacts, motion.timestep)
    rest = rest_speed(model, motion)
    first = next((one for one in found if one.closing_speed > rest), None)
    if first is None:
        return None
    before = step_of(motion.time, first.time)
    bodies = _bodies(model, first, geom_ids)
    after, belonging = before, [first]
    trees = model.body_treeid
    while True:
        after = _end(model, motion, seen, before, bodies, first.closing_speed)
        belonging = [
            one
            for one in found
            if first.time <= one.time <= motion.time[after]
            and {trees[b] for b in _bodies(model, one, geom_ids)}
            & {trees[b] for b in bodies}
        ]
        more = [b for one in belonging for b in _bodies(model, one, geom_ids)]
        grown = tuple(dict.fromkeys([*bodies, *more]))
        if grown == bodies:
            break
        bodies = grown
    one, other = (geom_ids[name] for name in first.geoms)
    return FirstImpact(
        time=first.time,
        closing_speed=first.closing_speed,
        geoms=(one, other),
        bodies=bodies,
        meetings=tuple(belonging),
        before=before,
        after=after,
    )


def window_of(
    model: mujoco.MjModel, first: FirstImpact, motion: Trajectory, seen: Survey
) -> tuple[int, int] | None:
    """Returns the samples before and after the first impact as another motion has it.

    Args:
        model: The scene without the plugin.
        first: The first impact of our motion.
        motion: The other motion.
        seen: What was seen of it.

    Returns:
        None if the two geoms do not meet near that time.
    """
    pair = tuple(sorted(first.geoms))
    begun = [
        one.first - 1
        for one in seen.touches
        if one.pair == pair and one.first >= max(1, first.before - QUIET)
    ]
    if not begun:
        return None
    before = begun[0]
    return before, _end(model, motion, seen, before, first.bodies, first.closing_speed)


def _bodies(
    model: mujoco.MjModel, meeting: Meeting, geom_ids: dict[str, int]
) -> tuple[int, ...]:
    """Returns the bodies of an impact that can move."""
    bodies = [int(model.geom_bodyid[geom_ids[name]]) for name in meeting.geoms]
    return tuple(body for body in bodies if model.body_weldid[body] != 0)


def _end(
    model: mujoco.MjModel,
    motion: Trajectory,
    seen: Survey,
    before: int,
    bodies: tuple[int, ...],
    speed: float,
) -> int:
    """Returns the first sample at which none of the bodies is being struck any more."""
    step = float(motion.time[1] - motion.time[0])
    last = min(len(motion.time) - 1, before + max(QUIET, round(LONGEST_CONTACT / step)))
    change = np.diff(seen.velocities[: last + 1, bodies], axis=0)
    usual = change[before - 1] if before else np.zeros_like(change[0])
    size = np.linalg.norm(change[before:] - usual, axis=2).max(axis=1)
    gravity = float(np.linalg.norm(model.opt.gravity))
    jumps = size > WEIGHTS * gravity * step + JUMP * speed
    quiet = 0
    for number, jumping in enumerate(jumps[1:], start=1):
        quiet = 0 if jumping else quiet + 1
        if quiet == QUIET:
            return before + number - QUIET + 1
    return last


def velocities_at(
    motion: Trajectory, seen: Survey, sample: int, bodies: tuple[int, ...], free: Array
) -> Array:
    """Returns the velocities of bodies at the time of a sample [m/s], shape (n, 3).

    Semi-implicit steps leave velocities half a step behind the positions.

    Args:
        motion: The motion.
        seen: What was seen of it.
        sample: Number of the sample.
        bodies: Ids of the n bodies.
        free: Their acceleration without impacts [m/s²], shape (n, 3).
    """
    from mujoco_impact.comparing.survey import HALF_STEP_INTEGRATORS

    half = 0.5 * motion.timestep if motion.integrator in HALF_STEP_INTEGRATORS else 0.0
    found: Array = seen.velocities[sample, bodies] + half * free
    return found
