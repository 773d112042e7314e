"""One step of the law: the Runge-Kutta-Nyström pair 4(3) of compression.cc.

Of Dormand, El-Mikkawy and Prince; the last stage of a step is the first of the next.
"""

import warp as wp

from mujoco_impact.warp.hertz import Scale
from mujoco_impact.warp.memory import Contacts

wp.set_module_options({"enable_backward": False})

# of the scale of speeds, in units of the tolerance: what is slower is at rest
SPEED_FLOOR = wp.constant(0.1)

# below this restitution the expansion is so fast that it is over at once
_NO_EXPANSION = wp.constant(1.0e-3)

# of the compression that the tolerance allows: what missing a turn may put it off by
_TURN_ERROR = wp.constant(0.3)


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
    floor = SPEED_FLOOR * tolerance * scale.speed
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
