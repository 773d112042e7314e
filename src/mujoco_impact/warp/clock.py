"""When an impact is over, and what comes next in it (plugin/law/impact_clock.cc)."""

import warp as wp

from mujoco_impact.warp.hertz import Scale
from mujoco_impact.warp.memory import Contacts
from mujoco_impact.warp.nystrom import SPEED_FLOOR

wp.set_module_options({"enable_backward": False})

# contact times after a force within which a closing belongs to the same impact
SAME_IMPACT_TIMES = wp.constant(5.0)

# a compression that no speed makes up for [m]
_LEFT_ALONE = wp.constant(-1.0e30)


@wp.func
def is_over(
    z: Contacts, w: int, n: int, scale: Scale, tolerance: float, time_left: float
) -> bool:
    """Whether every contact has opened, or will not close in time."""
    y_floor = tolerance * scale.compression
    c_floor = SPEED_FLOOR * tolerance * scale.speed
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
