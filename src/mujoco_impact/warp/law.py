"""The law `hertz` of an impact, as plugin/law/compression.cc integrates it.

    dc/dt = −W F    F_k = K_k y_k³ᐟ²    dy_k/dt = c_k, or c_k/e² while expanding

by the Runge-Kutta-Nyström pair 4(3) of Dormand, El-Mikkawy and Prince, since the force
depends on y alone. A contact that meets nobody else is a closed form.
"""

import warp as wp

from mujoco_impact.warp.memory import Contacts

wp.set_module_options({"enable_backward": False})

# T = 4/5 B(2/5, 1/2) y_max / u
_CONTACT_TIME = wp.constant(2.9432751842247047)

# below this restitution the expansion is so fast that it is over at once
_NO_EXPANSION = wp.constant(1.0e-3)

# of the compression that the tolerance allows: what missing a turn may put it off by
_TURN_ERROR = wp.constant(0.3)

# parts of the scale, in units of the tolerance, below which contacts are over
_SPEED_FLOOR = wp.constant(0.1)

# contact times after a force within which a closing belongs to the same impact
SAME_IMPACT_TIMES = wp.constant(5.0)

# a compression that no speed makes up for [m]
_LEFT_ALONE = wp.constant(-1.0e30)


@wp.struct
class Scale:
    """Natural scales of an impact, from the contact that closes fastest."""

    speed: float
    compression: float
    time: float  # shortest contact time at that speed [s]


@wp.struct
class Single:
    """The impact of one contact."""

    impulse: float
    duration: float
    moment: float  # about the onset


@wp.struct
class Span:
    """How long an impact took."""

    time: float  # [s]
    steps: int
    ended: bool


@wp.func
def maximum_compression(K: float, mass: float, u: float) -> float:
    """y_max = (5 μ u² / (4 K))^(2/5)."""
    return wp.pow(1.25 * mass * u * u / K, 0.4)


@wp.func
def contact_time(K: float, mass: float, u: float) -> float:
    """T of a contact of that reduced mass."""
    return _CONTACT_TIME * maximum_compression(K, mass, u) / u


@wp.func
def solve_single(K: float, mass: float, u: float, e: float) -> Single:
    """P = (1 + e) μ u, W = (1 + e) T/2, M = W P − μ (u W − (1 − e²) y_max)."""
    single = Single()
    y_max = maximum_compression(K, mass, u)
    single.impulse = (1.0 + e) * mass * u
    single.duration = 0.5 * (1.0 + e) * _CONTACT_TIME * y_max / u
    single.moment = single.duration * single.impulse - mass * (
        u * single.duration - (1.0 - e * e) * y_max
    )
    return single


@wp.func
def measure(z: Contacts, w: int, n: int) -> Scale:
    """The scale of the impact."""
    scale = Scale()
    fastest = int(0)
    for k in range(n):
        if z.closing[k, w] > scale.speed:
            scale.speed = z.closing[k, w]
            fastest = k
    scale.time = float(1.0e30)
    if scale.speed > 0.0:
        scale.compression = maximum_compression(
            z.K[fastest, w], 1.0 / z.W[fastest, fastest, w], scale.speed
        )
        for k in range(n):
            mass = 1.0 / z.W[k, k, w]
            scale.time = wp.min(scale.time, contact_time(z.K[k, w], mass, scale.speed))
    return scale


@wp.func
def multiply(
    W: wp.array3d[float], F: wp.array2d[float], G: wp.array2d[float], w: int, n: int
) -> None:
    """G = W F."""
    for k in range(n):
        s = float(0.0)
        for j in range(n):
            s += W[k, j, w] * F[j, w]
        G[k, w] = s


@wp.func
def force(K: float, y: float) -> float:
    """K y³ᐟ² of what is pressed."""
    pressed = wp.max(y, 0.0)
    return K * pressed * wp.sqrt(pressed)


@wp.func
def first_stage(z: Contacts, w: int, n: int) -> None:
    """Forces at the beginning of a step."""
    for k in range(n):
        z.F1[k, w] = force(z.K[k, w], z.y[k, w])
    multiply(z.W, z.F1, z.G1, w, n)


@wp.func
def try_step(
    z: Contacts, w: int, n: int, h: float, scale: Scale, tolerance: float
) -> float:
    """Advances y, c by h into y_new, c_new; returns the error over the tolerance."""
    hh = h * h
    for k in range(n):
        way = 0.25 * h * z.c[k, w] - hh / 32.0 * z.G1[k, w]
        z.F2[k, w] = force(z.K[k, w], z.y[k, w] + z.rate[k, w] * way)
    multiply(z.W, z.F2, z.G2, w, n)
    for k in range(n):
        pull = 7.0 / 1000.0 * z.G1[k, w] + 119.0 / 500.0 * z.G2[k, w]
        way = 0.7 * h * z.c[k, w] - hh * pull
        z.F3[k, w] = force(z.K[k, w], z.y[k, w] + z.rate[k, w] * way)
    multiply(z.W, z.F3, z.G3, w, n)
    for k in range(n):
        pull = (
            1.0 / 14.0 * z.G1[k, w]
            + 8.0 / 27.0 * z.G2[k, w]
            + 25.0 / 189.0 * z.G3[k, w]
        )
        z.y_new[k, w] = z.y[k, w] + z.rate[k, w] * (h * z.c[k, w] - hh * pull)
        z.F4[k, w] = force(z.K[k, w], z.y_new[k, w])
    multiply(z.W, z.F4, z.G4, w, n)
    y_error = float(0.0)
    c_error = float(0.0)
    for k in range(n):
        a = z.G1[k, w]
        b = z.G2[k, w]
        c = z.G3[k, w]
        d = z.G4[k, w]
        pull = 1.0 / 14.0 * a + 32.0 / 81.0 * b + 250.0 / 567.0 * c + 5.0 / 54.0 * d
        z.c_new[k, w] = z.c[k, w] - h * pull
        dy = (1.0 / 14.0 + 7.0 / 150.0) * a + (8.0 / 27.0 - 67.0 / 150.0) * b
        dy += (25.0 / 189.0 - 3.0 / 20.0) * c + 1.0 / 20.0 * d
        dc = (1.0 / 14.0 - 13.0 / 21.0) * a + (32.0 / 81.0 + 20.0 / 27.0) * b
        dc += (250.0 / 567.0 - 275.0 / 189.0) * c + (5.0 / 54.0 + 1.0 / 3.0) * d
        y_error = wp.max(y_error, z.rate[k, w] * wp.abs(dy))
        c_error = wp.max(c_error, wp.abs(dc))
    return (
        wp.max(hh * y_error / scale.compression, h * c_error / scale.speed) / tolerance
    )


@wp.func
def fraction_to_turn(
    z: Contacts, w: int, n: int, h: float, scale: Scale, tolerance: float
) -> float:
    """Part of the step after which a contact turns to expansion or back."""
    floor = _SPEED_FLOOR * tolerance * scale.speed
    fraction = float(1.0)
    for k in range(n):
        c = z.c[k, w]
        c_new = z.c_new[k, w]
        if z.y_new[k, w] > 0.0 and c * c_new < 0.0 and wp.abs(c_new) > floor:
            e = z.e[k, w]
            overshoots = bool(True)
            if e >= _NO_EXPANSION:
                # y is off by ½ |c_new| δt (1/e² − 1)
                late = h * c_new / (c_new - c)
                error = 0.5 * wp.abs(c_new) * late * (1.0 / (e * e) - 1.0)
                overshoots = error > _TURN_ERROR * tolerance * scale.compression
            if overshoots:
                fraction = wp.min(fraction, c / (c - c_new))
    return fraction


@wp.func
def accept(z: Contacts, w: int, n: int, t: float, h: float) -> None:
    """Takes the step that was tried at time t."""
    for k in range(n):
        if z.P[k, w] == 0.0 and z.F2[k, w] + z.F3[k, w] + z.F4[k, w] > 0.0:
            z.onset[k, w] = t
        a = z.F1[k, w]
        b = z.F2[k, w]
        c = z.F3[k, w]
        dP = h * (
            1.0 / 14.0 * a
            + 32.0 / 81.0 * b
            + 250.0 / 567.0 * c
            + 5.0 / 54.0 * z.F4[k, w]
        )
        # ∫ t F over the step = (t + h) ΔP − ∫ (h − s) F ds
        remaining = h * h * (1.0 / 14.0 * a + 8.0 / 27.0 * b + 25.0 / 189.0 * c)
        z.M[k, w] = z.M[k, w] + ((t + h) * dP - remaining)
        z.P[k, w] = z.P[k, w] + dP
        z.y[k, w] = z.y_new[k, w]
        z.c[k, w] = z.c_new[k, w]
        z.F1[k, w] = z.F4[k, w]
        z.G1[k, w] = z.G4[k, w]


@wp.func
def set_rates(z: Contacts, w: int, n: int, floor: float) -> None:
    """The rates of expansion; a contact that may not expand drops its compression."""
    dropped = bool(False)
    for k in range(n):
        # one that opened within the step did so at c, not at c/e²
        if z.y[k, w] < 0.0:
            z.y[k, w] = z.y[k, w] / z.rate[k, w]
        ahead = z.c[k, w]
        if wp.abs(ahead) < floor:
            ahead = -z.G1[k, w]
        z.rate[k, w] = 1.0
        if z.y[k, w] > 0.0 and ahead < 0.0:
            e = z.e[k, w]
            if e < _NO_EXPANSION:
                z.y[k, w] = 0.0
                dropped = True
            else:
                z.rate[k, w] = 1.0 / (e * e)
    if dropped:
        first_stage(z, w, n)


@wp.func
def is_over(
    z: Contacts, w: int, n: int, scale: Scale, tolerance: float, time_left: float
) -> bool:
    """Whether every contact has opened, or will not close in time."""
    y_floor = tolerance * scale.compression
    c_floor = _SPEED_FLOOR * tolerance * scale.speed
    for k in range(n):
        y = z.y[k, w]
        c = z.c[k, w]
        if y > y_floor:
            return False
        if c > c_floor and (y >= 0.0 or -y < c * time_left):
            return False
    return True


@wp.func
def is_any_pressed(z: Contacts, w: int, n: int) -> bool:
    """Whether any contact is compressed."""
    for k in range(n):
        if z.y[k, w] > 0.0:
            return True
    return False


@wp.func
def fly(z: Contacts, w: int, n: int, longest: float) -> float:
    """Flies to the next closing; returns the time that took, −1 if none comes."""
    flight = float(longest)
    closing = int(-1)
    for k in range(n):
        c = z.c[k, w]
        if c > 0.0 and -z.y[k, w] <= flight * c:
            flight = -z.y[k, w] / c
            closing = k
    if closing < 0:
        return -1.0
    for k in range(n):
        z.y[k, w] = z.y[k, w] + flight * z.c[k, w]
    z.y[closing, w] = 0.0
    return flight


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
def leave_late(z: Contacts, w: int, n: int) -> None:
    """Leaves the contacts alone that would begin an impact of their own."""
    for k in range(n):
        if z.y[k, w] < 0.0 and z.c[k, w] > 0.0:
            pressed = bool(False)
            for j in range(n):
                if j != k and z.W[k, j, w] != 0.0 and z.y[j, w] > 0.0:
                    pressed = True
            if not pressed:
                z.y[k, w] = _LEFT_ALONE


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
    if scale.speed == 0.0:
        return span
    first_stage(z, w, n)
    c_floor = _SPEED_FLOOR * tolerance * scale.speed
    same_impact = SAME_IMPACT_TIMES * scale.time
    # a twentieth of the contact time, then as the error says
    first_step = 0.05 * scale.time
    h = float(first_step)
    t = float(0.0)
    turns = int(0)
    going = bool(True)
    while going:
        longest = wp.min(wp.max(flight, same_impact), horizon + same_impact - t)
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
                t += flown
                alone = closing_alone(z, w, n)
                h = wp.min(h, first_step)
                first_stage(z, w, n)
        if going:
            span.steps += 1
            if alone >= 0:
                t += collide_alone(z, w, n, alone, t)
                first_stage(z, w, n)
                if t >= horizon + same_impact:
                    leave_late(z, w, n)
            else:
                error = try_step(z, w, n, h, scale, tolerance)
                growth = wp.clamp(0.9 / wp.sqrt(wp.sqrt(error + 1.0e-10)), 0.2, 5.0)
                fraction = float(1.0)
                # two secant steps put the turn within the speed floor
                if error <= 1.0 and not lossless and turns < 3:
                    fraction = fraction_to_turn(z, w, n, h, scale, tolerance)
                if error > 1.0:
                    h *= growth
                elif fraction < 1.0:
                    h *= wp.max(fraction, 1.0e-3)
                    turns += 1
                else:
                    turns = 0
                    accept(z, w, n, t, h)
                    t += h
                    if not lossless:
                        set_rates(z, w, n, c_floor)
                    if t >= horizon + same_impact:
                        leave_late(z, w, n)
                    h *= growth
    span.time = t
    return span
