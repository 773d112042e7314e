"""No impact adds kinetic energy, an elastic one takes none (plugin/law/passivity.h).

Impulses P on contacts with closing speeds c change it by −cᵀP + ½ PᵀWP, which is zero
for s* P, s* = 2 cᵀP / (PᵀWP).
"""

import warp as wp

from mujoco_impact.warp.memory import Contacts
from mujoco_impact.warp.nystrom import multiply

wp.set_module_options({"enable_backward": False})

# a factor beyond is no correction: the pushes cancel each other
_MOST_SCALE = wp.constant(10.0)


@wp.func
def dot(a: wp.array2d[float], b: wp.array2d[float], w: int, n: int) -> float:
    """aᵀ b of a world."""
    s = float(0.0)
    for k in range(n):
        s += a[k, w] * b[k, w]
    return s


@wp.func
def remove_gain(z: Contacts, w: int, n: int, linear: float, quadratic: float) -> None:
    """P + λ D⁻¹ c', c' = c − W P: takes away the energy that impulses add, if any."""
    gain = 0.5 * quadratic - linear
    if gain <= 0.0:
        return
    # G1 holds W P
    for k in range(n):
        z.c[k, w] = z.closing[k, w] - z.G1[k, w]
        z.F2[k, w] = 0.0
        if z.P[k, w] > 0.0:
            z.F2[k, w] = z.c[k, w] / z.W[k, k, w]
    multiply(z.W, z.F2, z.G2, w, n)
    slope = dot(z.c, z.F2, w, n)
    root = slope * slope - 2.0 * dot(z.F2, z.G2, w, n) * gain
    if slope <= 0.0 or root < 0.0:
        return
    scale = 2.0 * gain / (slope + wp.sqrt(root))
    for k in range(n):
        if z.P[k, w] > 0.0:
            changed = wp.max(z.P[k, w] + scale * z.F2[k, w], 0.0)
            z.M[k, w] = z.M[k, w] * (changed / z.P[k, w])
            z.P[k, w] = changed


@wp.func
def keep_energy(z: Contacts, w: int, n: int) -> None:
    """Scales P and M so that no energy is added, nor lost if all is elastic."""
    multiply(z.W, z.P, z.G1, w, n)
    linear = dot(z.closing, z.P, w, n)
    quadratic = dot(z.P, z.G1, w, n)
    factor = float(0.0)
    if quadratic > 0.0 and linear > 0.0:
        factor = 2.0 * linear / quadratic
    if factor <= 0.0 or factor >= _MOST_SCALE:
        remove_gain(z, w, n, linear, quadratic)
        return
    for k in range(n):
        if z.e[k, w] < 1.0:
            factor = wp.min(factor, 1.0)
    for k in range(n):
        z.P[k, w] = factor * z.P[k, w]
        z.M[k, w] = factor * z.M[k, w]
