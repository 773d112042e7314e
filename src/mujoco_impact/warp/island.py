"""The contacts of one impact, and their rows where the first of them closes."""

import warp as wp

from mujoco_impact.warp.clock import SAME_IMPACT_TIMES
from mujoco_impact.warp.hertz import contact_time
from mujoco_impact.warp.memory import Bodies, Contacts, Pairs, Paths, World
from mujoco_impact.warp.path import (
    Sight,
    acceleration,
    coordinates,
    displacement,
    look_at,
    to_joint,
)
from mujoco_impact.warp.scene import FIXED

wp.set_module_options({"enable_backward": False})

# of a step: contacts that close after a shorter flight belong to the same impact
SAME_IMPACT = wp.constant(0.1)

# over the speed of the closing: a heavy ball sends a light one off at twice its own
_FASTEST = wp.constant(2.0)

_FIXED = wp.constant(FIXED)


@wp.func
def row(bodies: Bodies, paths: Paths, x: int, w: int, t: float, n: wp.vec3) -> wp.vec3:
    """nᵀ ∂x/∂q of the centre of body x at time t."""
    moved = displacement(bodies, x, coordinates(paths, x, w, t))
    return to_joint(bodies, x, moved, n)


@wp.func
def reach_of(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    p: int,
    w: int,
    t: float,
    h: float,
    sight: Sight,
) -> float:
    """Gap up to which a contact beside the pair p may belong to its impact [m]."""
    inverse_mass = float(0.0)
    for side in range(2):
        x = pairs.first[p]
        if side == 1:
            x = pairs.second[p]
        J = row(bodies, paths, x, w, t, sight.normal)
        inverse_mass += paths.mobility[x, w] * wp.dot(J, J)
    T = contact_time(pairs.stiffness[p], 1.0 / inverse_mass, -sight.rate)
    time = wp.max(wp.min(SAME_IMPACT * h, h - t), SAME_IMPACT_TIMES * T)
    return -_FASTEST * sight.rate * time


@wp.func
def touch_body(bodies: Bodies, paths: Paths, x: int, w: int, number: int) -> None:
    """Notes that a body takes part in the round of that number."""
    if bodies.kind[x] != _FIXED:
        paths.round[x, w] = number


@wp.func
def gather(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    z: Contacts,
    world: World,
    first: int,
    w: int,
    t: float,
    h: float,
    number: int,
) -> int:
    """Finds the pairs of the impact that pair `first` begins at time t.

    Returns how many they are; those beyond the capacity are counted and left out.
    """
    sight = look_at(bodies, pairs, paths, first, w, t)
    reach = reach_of(bodies, pairs, paths, first, w, t, h, sight)
    capacity = z.pair.shape[0]
    z.pair[0, w] = first
    world.member[first, w] = number
    touch_body(bodies, paths, pairs.first[first], w, number)
    touch_body(bodies, paths, pairs.second[first], w, number)
    n = int(1)
    grows = bool(True)
    while grows:
        grows = bool(False)
        for p in range(pairs.first.shape[0]):
            one = pairs.first[p]
            two = pairs.second[p]
            beside = paths.round[one, w] == number or paths.round[two, w] == number
            if beside and world.member[p, w] != number:
                other = look_at(bodies, pairs, paths, p, w, t)
                if other.gap + wp.min(other.rate, 0.0) * (h - t) <= reach:
                    if n < capacity:
                        z.pair[n, w] = p
                    world.member[p, w] = number
                    touch_body(bodies, paths, one, w, number)
                    touch_body(bodies, paths, two, w, number)
                    n += 1
                    grows = True
    return n


@wp.func
def shared(pairs: Pairs, paths: Paths, z: Contacts, k: int, j: int, w: int) -> float:
    """W_kj = J_k M⁻¹ J_jᵀ, over the bodies that both contacts have."""
    value = float(0.0)
    for side in range(2):
        x = pairs.first[z.pair[k, w]]
        J = z.J1[k, w]
        if side == 1:
            x = pairs.second[z.pair[k, w]]
            J = z.J2[k, w]
        if x == pairs.first[z.pair[j, w]]:
            value += paths.mobility[x, w] * wp.dot(J, z.J1[j, w])
        if x == pairs.second[z.pair[j, w]]:
            value += paths.mobility[x, w] * wp.dot(J, z.J2[j, w])
    return value


@wp.func
def make_rows(
    bodies: Bodies, pairs: Pairs, paths: Paths, z: Contacts, n: int, w: int, t: float
) -> None:
    """Rows, gaps, closing speeds and the Delassus matrix at time t."""
    for k in range(n):
        p = z.pair[k, w]
        one = pairs.first[p]
        two = pairs.second[p]
        sight = look_at(bodies, pairs, paths, p, w, t)
        J1 = -row(bodies, paths, one, w, t, sight.normal)
        J2 = row(bodies, paths, two, w, t, sight.normal)
        z.J1[k, w] = J1
        z.J2[k, w] = J2
        z.closing[k, w] = -sight.rate
        z.pressing[k, w] = -wp.dot(J1, acceleration(paths, one, w, t)) - wp.dot(
            J2, acceleration(paths, two, w, t)
        )
        z.gap[k, w] = wp.where(sight.gap <= pairs.touch[p], 0.0, sight.gap)
        z.K[k, w] = pairs.stiffness[p]
        z.e[k, w] = pairs.restitution[p]
    # the one that begins it has closed, but for rounding
    z.gap[0, w] = 0.0
    for k in range(n):
        for j in range(n):
            z.W[k, j, w] = shared(pairs, paths, z, k, j, w)
