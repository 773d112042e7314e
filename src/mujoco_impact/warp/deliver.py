"""How the impulses of an impact get into the step.

The positions get the moments of the impulses, so that bodies are where the impact's own
timing puts them (plugin/engine/resolve/resolve.cc, overlap.cc and deliver/deliver.h).
"""

import warp as wp

from mujoco_impact.warp.memory import Bodies, Contacts, Pairs, Paths
from mujoco_impact.warp.nystrom import multiply
from mujoco_impact.warp.path import look
from mujoco_impact.warp.scene import FIXED, FREE

wp.set_module_options({"enable_backward": False})

# beyond this part of the work bodies are pressed and not struck
_MOST_MEANWHILE = wp.constant(0.1)

_SWEEPS = wp.constant(100)
_OF_ROOM = wp.constant(1.0e-3)

_FREE = wp.constant(FREE)
_FIXED = wp.constant(FIXED)


@wp.func
def room_within(pairs: Pairs, paths: Paths, bodies: Bodies, p: int, w: int) -> float:
    """How much deeper than at the start of the step the bodies may be left [m]."""
    still = wp.vec3(0.0)
    q1 = paths.q[pairs.first[p], w]
    q2 = paths.q[pairs.second[p], w]
    overlap = wp.max(-look(bodies, pairs, p, q1, still, q2, still).gap, 0.0)
    depth = pairs.depth[p]
    return wp.max(
        0.5 * depth - overlap, wp.max(0.25 * (depth - overlap), 1.0e-3 * depth)
    )


@wp.func
def press_out_dents(
    bodies: Bodies, pairs: Pairs, paths: Paths, z: Contacts, w: int, n: int, t: float
) -> None:
    """Takes out of the moments what contacts with a loss are left pressed at time t.

    They do not expand as far as they were pressed; within half of their depth they are
    not MuJoCo's then. y = c t − g − W (P t − M), by projected Gauss-Seidel sweeps.
    """
    inelastic = bool(False)
    for k in range(n):
        if z.e[k, w] < 1.0:
            inelastic = True
    if not inelastic:
        return
    # y_new: the overlap if the impulses came at once; c_new: what M has lost
    multiply(z.W, z.P, z.y_new, w, n)
    for k in range(n):
        z.y_new[k, w] = z.closing[k, w] * t - z.gap[k, w] - t * z.y_new[k, w]
        z.c_new[k, w] = 0.0
        z.F2[k, w] = room_within(pairs, paths, bodies, z.pair[k, w], w)
    going = bool(True)
    sweep = int(0)
    while going and sweep < _SWEEPS:
        going = bool(False)
        sweep += 1
        for k in range(n):
            if z.P[k, w] > 0.0:
                moved = float(0.0)
                for j in range(n):
                    moved += z.W[k, j, w] * z.M[j, w]
                W = z.W[k, k, w]
                excess = z.y_new[k, w] + moved - z.F2[k, w]
                change = wp.max(excess / W, -z.c_new[k, w])
                z.M[k, w] = z.M[k, w] - change
                z.c_new[k, w] = z.c_new[k, w] + change
                if wp.abs(change) * W > _OF_ROOM * z.F2[k, w]:
                    going = True


@wp.func
def count_forces_meanwhile(z: Contacts, w: int, n: int) -> None:
    """Scales the impulses for the forces that go on while bodies touch.

    By Σ (c_k + a_k t'_k) P_k / Σ c_k P_k, a_k the rate of c_k by those forces, t'_k how
    much later than the contact closes the impulse comes, over e.
    """
    work = float(0.0)
    meanwhile = float(0.0)
    for k in range(n):
        P = z.P[k, w]
        if P > 0.0:
            after = 1.0 / wp.max(z.e[k, w], 0.2)
            work += z.closing[k, w] * P
            onset = z.onset[k, w]
            until = P * onset + after * (z.M[k, w] - onset * P)
            meanwhile += z.pressing[k, w] * until
    if work > 0.0 and wp.abs(meanwhile) <= _MOST_MEANWHILE * work:
        factor = 1.0 + meanwhile / work
        for k in range(n):
            z.P[k, w] = factor * z.P[k, w]
            z.M[k, w] = factor * z.M[k, w]


@wp.func
def set_busy(bodies: Bodies, paths: Paths, x: int, w: int, until: float) -> None:
    """Notes until when an impact has body x."""
    if bodies.kind[x] != _FIXED:
        paths.busy[x, w] = until


@wp.func
def add_to_path(
    paths: Paths, x: int, w: int, J: wp.vec3, P: float, moment: float, h: float
) -> None:
    """Adds an impulse with its moment about the start of the step to body x."""
    # where dents are pressed out, what hardly pushes may have its moment far away
    time = wp.clamp(moment / P, -h, 4.0 * h)
    kick = paths.mobility[x, w] * J
    paths.P[x, w] = paths.P[x, w] + P * kick
    paths.M1[x, w] = paths.M1[x, w] + moment * kick
    paths.M2[x, w] = paths.M2[x, w] + P * time * time * kick


@wp.func
def add_impulses(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    z: Contacts,
    w: int,
    n: int,
    t: float,
    time: float,
    h: float,
) -> bool:
    """Adds the impulses of an impact that began at t; false if none pushes."""
    any_pushes = bool(False)
    for k in range(n):
        P = z.P[k, w]
        if P > 0.0:
            any_pushes = True
            moment = z.M[k, w] + t * P
            first = pairs.first[z.pair[k, w]]
            second = pairs.second[z.pair[k, w]]
            # zero for what is fixed
            add_to_path(paths, first, w, z.J1[k, w], P, moment, h)
            set_busy(bodies, paths, first, w, t + time)
            # zero for what is fixed
            add_to_path(paths, second, w, z.J2[k, w], P, moment, h)
            set_busy(bodies, paths, second, w, t + time)
    return any_pushes


@wp.func
def commit(
    bodies: Bodies,
    paths: Paths,
    x: int,
    w: int,
    h: float,
    implicit: int,
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
) -> None:
    """Adds what impacts did to body x to its state after MuJoCo's step.

    Δv = M⁻¹Jᵀ P, bent by what gravity and springs do along the way, and damped from the
    impulse on to the end of the step; Δq = h Δv − M⁻¹Jᵀ P s.
    """
    kind = bodies.kind[x]
    if kind == _FIXED:
        return
    P = paths.P[x, w]
    M1 = paths.M1[x, w]
    if wp.dot(P, P) == 0.0:
        return
    # −s (h − s)/2 G ΔV
    dv = P + paths.G[x, w] * (0.5 * paths.M2[x, w] - 0.5 * h * M1)
    if implicit == 1:
        # B/M, and M/(M + h B) as the integrator answers a force
        damping = paths.mobility[x, w] * bodies.damping[x]
        dv = (dv + damping * M1) / (1.0 + h * damping)
    dq = h * dv - M1
    adr = bodies.dofadr[x]
    place = bodies.qposadr[x]
    width = int(1)
    if kind == _FREE:
        width = 3
    for i in range(width):
        qvel[w, adr + i] = qvel[w, adr + i] + dv[i]
        qpos[w, place + i] = qpos[w, place + i] + dq[i]
