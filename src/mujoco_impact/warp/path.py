"""Where bodies are within a step, and the gap of two of them, without cancellation.

The semi-implicit integrators go from q to q + h v', v' = v + h a, which is the parabola

    q(t) = q + V t + a t²/2 + b t³/6,   V = v + h a/2,   a = (v' − v)/h,   b = G V

with G = ∂a/∂q by gravity and springs. Impulses P at times s of the step add
M⁻¹Jᵀ P (t − s).

Positions of balls that touch agree in all of the digits that single precision has for
a gap. So a gap is what it is in qpos0, computed in double precision, and how far the
two have moved since:

    two spheres:  gap = gap₀ + Δ·(2 D₀ + Δ) / (|D₀| + |D₀ + Δ|)
    a plane:      gap = gap₀ + n·Δx₂

D = x₂ − x₁, Δ how far that has changed.
"""

import warp as wp

from mujoco_impact.warp.memory import Bodies, Pairs, Paths
from mujoco_impact.warp.scene import FIXED, FREE, SLIDE

wp.set_module_options({"enable_backward": False})

_FREE = wp.constant(FREE)
_SLIDE = wp.constant(SLIDE)
_FIXED = wp.constant(FIXED)


@wp.struct
class Sight:
    """Two bodies at one time; the normal points to the second."""

    gap: float
    rate: float  # of the gap [m/s], negative: approaching
    normal: wp.vec3
    relative: wp.vec3  # velocity of the second from the first
    speed: float  # sum of their speeds


@wp.func
def coordinates(paths: Paths, x: int, w: int, t: float) -> wp.vec3:
    """Coordinates q of body x at time t, from qpos0."""
    V = paths.V[x, w]
    a = paths.a[x, w]
    b = paths.G[x, w] * V
    way = t * (V + t * (0.5 * a + t / 6.0 * b))
    return paths.q[x, w] + way + t * paths.P[x, w] - paths.M1[x, w]


@wp.func
def velocity(paths: Paths, x: int, w: int, t: float) -> wp.vec3:
    """Velocity of body x at time t: V + a t + b t²/2 + (1 + G (t − s)²/2) M⁻¹Jᵀ P."""
    V = paths.V[x, w]
    P = paths.P[x, w]
    G = paths.G[x, w]
    bent = 0.5 * G * (t * t * P - 2.0 * t * paths.M1[x, w] + paths.M2[x, w])
    return V + t * (paths.a[x, w] + 0.5 * t * G * V) + P + bent


@wp.func
def acceleration(paths: Paths, x: int, w: int, t: float) -> wp.vec3:
    """Acceleration of body x at time t: a + b t + G M⁻¹Jᵀ P (t − s)."""
    G = paths.G[x, w]
    way = t * (paths.V[x, w] + paths.P[x, w]) - paths.M1[x, w]
    return paths.a[x, w] + G * way


@wp.func
def turned(axis: wp.vec3, r: wp.vec3, angle: float) -> wp.vec3:
    """How far r gets by a rotation: sin q (n × r) + (1 − cos q) n × (n × r)."""
    across = wp.cross(axis, r)
    half = wp.sin(0.5 * angle)
    return wp.sin(angle) * across + 2.0 * half * half * wp.cross(axis, across)


@wp.func
def displacement(bodies: Bodies, x: int, q: wp.vec3) -> wp.vec3:
    """Δx of the centre of body x at the coordinates q."""
    kind = bodies.kind[x]
    axis = bodies.axis[x]
    if kind == _FIXED:
        return wp.vec3(0.0)
    if kind == _FREE:
        return q
    if kind == _SLIDE:
        return q[0] * axis
    return turned(axis, bodies.arm[x], q[0])


@wp.func
def slope(bodies: Bodies, x: int, moved: wp.vec3) -> wp.vec3:
    """∂x/∂q of a hinge or a slide whose centre has moved by that."""
    if bodies.kind[x] == _SLIDE:
        return bodies.axis[x]
    return wp.cross(bodies.axis[x], bodies.arm[x] + moved)


@wp.func
def to_world(bodies: Bodies, x: int, moved: wp.vec3, v: wp.vec3) -> wp.vec3:
    """Velocity of the centre by the velocity of the joint."""
    if bodies.kind[x] == _FREE:
        return v
    if bodies.kind[x] == _FIXED:
        return wp.vec3(0.0)
    return v[0] * slope(bodies, x, moved)


@wp.func
def to_joint(bodies: Bodies, x: int, moved: wp.vec3, n: wp.vec3) -> wp.vec3:
    """nᵀ ∂x/∂q: the row of a contact with that normal."""
    if bodies.kind[x] == _FREE:
        return n
    if bodies.kind[x] == _FIXED:
        return wp.vec3(0.0)
    return wp.vec3(wp.dot(n, slope(bodies, x, moved)), 0.0, 0.0)


@wp.func
def bend(bodies: Bodies, x: int, moved: wp.vec3, v: wp.vec3) -> wp.vec3:
    """Acceleration of the centre by the turning of a hinge: q'² n × (n × r)."""
    if bodies.kind[x] == _FREE or bodies.kind[x] == _SLIDE or bodies.kind[x] == _FIXED:
        return wp.vec3(0.0)
    return v[0] * v[0] * wp.cross(bodies.axis[x], slope(bodies, x, moved))


@wp.func
def look(
    bodies: Bodies,
    pairs: Pairs,
    p: int,
    q1: wp.vec3,
    v1: wp.vec3,
    q2: wp.vec3,
    v2: wp.vec3,
) -> Sight:
    """The pair p at the coordinates q and velocities v of its joints."""
    first = pairs.first[p]
    second = pairs.second[p]
    moved1 = displacement(bodies, first, q1)
    moved2 = displacement(bodies, second, q2)
    sight = Sight()
    u1 = to_world(bodies, first, moved1, v1)
    u2 = to_world(bodies, second, moved2, v2)
    sight.relative = u2 - u1
    sight.speed = wp.length(u1) + wp.length(u2)
    moved = moved2 - moved1
    between = pairs.between[p]
    if pairs.plane[p] == 1:
        sight.gap = pairs.gap[p] + wp.dot(between, moved)
        sight.normal = between
    else:
        D = between + moved
        length = wp.length(D)
        sight.gap = pairs.gap[p] + wp.dot(moved, between + D) / (
            wp.length(between) + length
        )
        sight.normal = D / wp.max(length, 1.0e-15)
    sight.rate = wp.dot(sight.normal, sight.relative)
    return sight


@wp.func
def look_at(
    bodies: Bodies, pairs: Pairs, paths: Paths, p: int, w: int, t: float
) -> Sight:
    """The pair p at time t."""
    first = pairs.first[p]
    second = pairs.second[p]
    return look(
        bodies,
        pairs,
        p,
        coordinates(paths, first, w, t),
        velocity(paths, first, w, t),
        coordinates(paths, second, w, t),
        velocity(paths, second, w, t),
    )


@wp.func
def of_joint(values: wp.array2d[float], w: int, adr: int, kind: int) -> wp.vec3:
    """Three numbers of a free joint, or one of a hinge or a slide."""
    if kind == _FIXED:
        return wp.vec3(0.0)
    if kind == _FREE:
        return wp.vec3(values[w, adr], values[w, adr + 1], values[w, adr + 2])
    return wp.vec3(values[w, adr], 0.0, 0.0)


@wp.func
def begin_path(
    bodies: Bodies,
    paths: Paths,
    x: int,
    w: int,
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    qvel_after: wp.array2d[float],
    h: float,
    gravity: wp.vec3,
) -> None:
    """The path of body x, from its state before MuJoCo's step and its velocity then."""
    kind = bodies.kind[x]
    q = of_joint(qpos, w, bodies.qposadr[x], kind) - bodies.zero[x]
    v = of_joint(qvel, w, bodies.dofadr[x], kind)
    v_after = of_joint(qvel_after, w, bodies.dofadr[x], kind)
    paths.q[x, w] = q
    paths.a[x, w] = (v_after - v) / h
    paths.V[x, w] = 0.5 * (v + v_after)
    inertia = bodies.inertia[x]
    paths.mobility[x, w] = 1.0 / inertia
    G = float(0.0)
    if kind != _FIXED and kind != _FREE:
        # ∂Q/∂q = m g·(n × (n × r)) − k
        G = -bodies.stiffness[x]
        if kind != _SLIDE:
            axis = bodies.axis[x]
            lever = bodies.lever[x]
            r = lever + turned(axis, lever, q[0])
            G += bodies.mass[x] * wp.dot(gravity, wp.cross(axis, wp.cross(axis, r)))
    paths.G[x, w] = G / inertia
    paths.P[x, w] = wp.vec3(0.0)
    paths.M1[x, w] = wp.vec3(0.0)
    paths.M2[x, w] = wp.vec3(0.0)
    paths.busy[x, w] = 0.0
    paths.round[x, w] = 0
