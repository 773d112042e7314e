"""One Hertz contact: how far it is pressed, how long it lasts, what it gives.

As plugin/law/hertz_contact.cc, single_impact.cc and impact_scale.cc have it.
"""

import warp as wp

from mujoco_impact.warp.memory import Contacts

wp.set_module_options({"enable_backward": False})

# T = 4/5 B(2/5, 1/2) y_max / u
_CONTACT_TIME = wp.constant(2.9432751842247047)


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
