"""The law `hertz` of an impact, as plugin/law/compression.cc integrates it.

    dc/dt = −W F    F_k = K_k y_k³ᐟ²    dy_k/dt = c_k, or c_k/e² while expanding

The force depends on y alone. A contact that meets nobody else is a closed form.
"""

import warp as wp

from mujoco_impact.warp.clock import (
    SAME_IMPACT_TIMES,
    fly,
    is_any_pressed,
    is_over,
    leave_late,
)
from mujoco_impact.warp.hertz import Scale, measure, solve_single
from mujoco_impact.warp.memory import Contacts
from mujoco_impact.warp.nystrom import (
    SPEED_FLOOR,
    accept,
    first_stage,
    fraction_to_turn,
    set_rates,
    try_step,
)

wp.set_module_options({"enable_backward": False})


@wp.struct
class Span:
    """How long an impact took."""

    time: float  # [s]
    steps: int
    ended: bool


@wp.struct
class Progress:
    """How far the impact is integrated."""

    t: float  # since it began [s]
    h: float  # the step to try next [s]
    turns: int  # steps in a row that were cut short where y turns


@wp.func
def closing_alone(z: Contacts, w: int, n: int) -> int:
    """The contact that has just closed, if nothing else can until it opens; else −1."""
    alone = int(-1)
    for k in range(n):
        if z.y[k, w] == 0.0 and z.c[k, w] > 0.0:
            if alone >= 0:
                return -1
            alone = k
    if alone < 0:
        return -1
    single = solve_single(
        z.K[alone, w], 1.0 / z.W[alone, alone, w], z.c[alone, w], z.e[alone, w]
    )
    for k in range(n):
        if k != alone:
            coupling = z.W[alone, k, w]
            # the impulse changes c by no more than that
            fastest = wp.max(z.c[k, w], 0.0) + wp.abs(coupling) * single.impulse
            if fastest > 0.0 and -z.y[k, w] <= fastest * single.duration:
                return -1
    return alone


@wp.func
def collide_alone(z: Contacts, w: int, n: int, k: int, t: float) -> float:
    """The whole impact of contact k in closed form; returns how long it takes."""
    single = solve_single(z.K[k, w], 1.0 / z.W[k, k, w], z.c[k, w], z.e[k, w])
    P = single.impulse
    T = single.duration
    if z.P[k, w] == 0.0:
        z.onset[k, w] = t
    z.P[k, w] = z.P[k, w] + P
    z.M[k, w] = z.M[k, w] + t * P + single.moment
    for j in range(n):
        # Δy = −W_kj ∫ (T − s) F ds
        coupling = z.W[k, j, w]
        z.y[j, w] = z.y[j, w] + z.c[j, w] * T - coupling * (T * P - single.moment)
        z.c[j, w] = z.c[j, w] - coupling * P
    z.y[k, w] = 0.0
    return T


@wp.func
def begin(z: Contacts, w: int, n: int) -> bool:
    """Puts the state when the impact begins; returns whether no contact has losses."""
    lossless = bool(True)
    for k in range(n):
        z.y[k, w] = -z.gap[k, w]
        z.c[k, w] = z.closing[k, w]
        z.rate[k, w] = 1.0
        z.P[k, w] = 0.0
        z.M[k, w] = 0.0
        z.onset[k, w] = 0.0
        if z.e[k, w] < 1.0:
            lossless = False
    return lossless


@wp.func
def advance(
    z: Contacts,
    w: int,
    n: int,
    now: Progress,
    scale: Scale,
    tolerance: float,
    lossless: bool,
) -> Progress:
    """Tries a step of h: takes it, or shortens h for the error or to where y turns."""
    after = Progress()
    after.t = now.t
    after.h = now.h
    after.turns = now.turns
    error = try_step(z, w, n, now.h, scale, tolerance)
    growth = wp.clamp(0.9 / wp.sqrt(wp.sqrt(error + 1.0e-10)), 0.2, 5.0)
    if error > 1.0:
        after.h = now.h * growth
        return after
    # two secant steps put the turn within the speed floor
    if not lossless and now.turns < 3:
        fraction = fraction_to_turn(z, w, n, now.h, scale, tolerance)
        if fraction < 1.0:
            after.h = now.h * wp.max(fraction, 1.0e-3)
            after.turns = now.turns + 1
            return after
    accept(z, w, n, now.t, now.h)
    if not lossless:
        set_rates(z, w, n, SPEED_FLOOR * tolerance * scale.speed)
    after.t = now.t + now.h
    after.h = now.h * growth
    after.turns = 0
    return after


@wp.func
def integrate(
    z: Contacts,
    w: int,
    n: int,
    tolerance: float,
    horizon: float,
    flight: float,
    most_steps: int,
) -> Span:
    """Integrates the impact into P, M and onset, from `closing` and `gap` on."""
    scale = measure(z, w, n)
    span = Span()
    span.ended = True
    lossless = begin(z, w, n)
    if scale.speed == 0.0:
        return span
    first_stage(z, w, n)
    same_impact = SAME_IMPACT_TIMES * scale.time
    # a twentieth of the contact time, then as the error says
    first_step = 0.05 * scale.time
    now = Progress()
    now.h = first_step
    going = bool(True)
    while going:
        longest = wp.min(wp.max(flight, same_impact), horizon + same_impact - now.t)
        alone = int(-1)
        if is_over(z, w, n, scale, tolerance, longest):
            going = False
        elif span.steps >= most_steps:
            going = False
            span.ended = False
        elif not is_any_pressed(z, w, n):
            flown = fly(z, w, n, longest)
            if flown < 0.0:
                going = False
            else:
                now.t += flown
                now.h = wp.min(now.h, first_step)
                alone = closing_alone(z, w, n)
                first_stage(z, w, n)
        if going:
            span.steps += 1
            if alone >= 0:
                now.t += collide_alone(z, w, n, alone, now.t)
                first_stage(z, w, n)
            else:
                now = advance(z, w, n, now, scale, tolerance, lossless)
            if now.t >= horizon + same_impact:
                leave_late(z, w, n)
    span.time = now.t
    return span
