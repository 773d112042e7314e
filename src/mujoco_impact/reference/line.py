"""The first impact of a straight row, without gravity: final velocities.

Balls on a line with Hertz contacts and energetic restitution, the truth that an impact
law has to meet. In virtual compressions y (the real ones if restitution is 1)

    m_i v_i' = F_(i-1) - F_i,     F_k = K_k max(y_k, 0)^1.5,     c_k = v_k - v_(k+1),
    y_k' = c_k.

Two ways to lose energy:

* bi-stiffness [Liu, Zhao and Brogliato 2008]: y_k' = c_k / e^2 where a compressed
  contact expands (c_k < 0 < y_k), so that expansion gives back the fraction e^2 of the
  work of compression at every contact (energetic restitution), at any speed. As in
  their law a contact that has expanded waits at y_k = 0 and is compressed again as soon
  as c_k > 0: the balls are still dented into each other then.
* Hunt and Crossley (1975): the force carries the factor 1 + a c_k, a such that a single
  pair rebounds with e at the impact speed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from mujoco_impact.reference.chain import ChainError, FloatArray, hertz_stiffness

Dissipation = Literal["bistiffness", "hunt-crossley"]

#: Compression that counts as touching, in units of the impact.
TOUCH = 1e-13

#: Bi-stiffness: compressions nearer to zero than this are those of a contact that has
#: expanded, larger negative ones are gaps; in units of the impact.
EXPANDED = 1e-9

#: Closing speed that counts as zero, in fractions of the impact speed.
STILL = 1e-12

#: Longest contact of any pairs, in units of the impact; one pair needs about 2.4.
LONGEST = 1e5


@dataclass(frozen=True)
class FirstImpact:
    """What an impact leaves behind.

    Attributes:
        velocities: Final velocities in fractions of the impact speed, shape (n,).
        impulses: Impulse of each pair [N s], shape (n - 1,).
        duration: Time from first touch to last separation [s].
        energy_ratio: Final over initial kinetic energy.
    """

    velocities: FloatArray
    impulses: FloatArray
    duration: float
    energy_ratio: float


def first_impact(
    masses: Sequence[float],
    radii: Sequence[float],
    *,
    n_incoming: int = 1,
    gap: float | Sequence[float] = 0.0,
    speed: float = 1.0,
    young: float = 2e11,
    poisson: float = 0.3,
    restitution: float = 1.0,
    dissipation: Dissipation | None = None,
    rtol: float = 1e-12,
) -> FirstImpact:
    """Return the outcome of the first balls of a row hitting the others at rest.

    Follows the row until no pair closes any more. With touching balls the velocities
    depend on the mass and stiffness ratios only, not on `speed` or `young`.

    Args:
        masses: Masses, left to right [kg], n of them.
        radii: Radii [m], n of them.
        n_incoming: Number of balls that come in together from the left, 1 to n - 1.
        gap: Gap before each pair closes [m], one for all or one for each pair.
        speed: Speed of the incoming balls [m/s].
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        restitution: Coefficient of restitution of every pair, above 0 to 1.
        dissipation: How energy is lost; needed if `restitution` is below 1.
        rtol: Relative tolerance of DOP853, 1e-13 to 1e-3.

    Raises:
        ChainError: A parameter lies outside its range.
    """
    _check(masses, radii, gap, n_incoming, speed, restitution, dissipation, rtol)
    mass = np.array(masses, dtype=float)
    stiffness = np.array(
        [
            hertz_stiffness(left, right, young, poisson)
            for left, right in itertools.pairwise(radii)
        ]
    )
    # Units: mass of the first ball, stiffness of the first pair, impact speed.
    length = (mass[0] * speed**2 / stiffness[0]) ** 0.4
    row = _Row(mass / mass[0], stiffness / stiffness[0], restitution, dissipation, rtol)
    velocity = np.where(np.arange(len(mass)) < n_incoming, 1.0, 0.0)
    compression = -np.broadcast_to(np.asarray(gap, dtype=float), stiffness.shape)
    final, time = row.separate(velocity, compression / length)
    impulses = speed * np.cumsum(mass * (velocity - final))[:-1]
    energy = float(mass @ final**2 / (mass @ velocity**2))
    return FirstImpact(final, impulses, float(time * length / speed), energy)


def hunt_crossley_factor(restitution: float) -> float:
    """Return a v, the factor of the force K y^1.5 (1 + a c) at the impact speed v.

    Integrating mu c dc = -K y^1.5 (1 + a c) dy over one impact of a pair gives
    a v (1 + e) = ln((1 + a v) / (1 - a v e)).

    Args:
        restitution: e, above 0 to 1.
    """
    from scipy.optimize import brentq

    if restitution == 1:
        return 0.0

    def mismatch(factor: float) -> float:
        logarithm = math.log1p(factor) - math.log1p(-factor * restitution)
        return factor * (1 + restitution) - logarithm

    # The root at 0 is trivial; the other one lies below the pole at 1 / e.
    return float(brentq(mismatch, 1e-9, (1 - 1e-15) / restitution, xtol=1e-15))


@dataclass(frozen=True)
class _Row:
    """A straight row in units of its impact."""

    mass: FloatArray
    stiffness: FloatArray
    restitution: float
    dissipation: Dissipation | None
    rtol: float

    @cached_property
    def damping(self) -> float:
        """Factor a of Hunt and Crossley, in units of the impact."""
        return hunt_crossley_factor(self.restitution)

    def separate(
        self, velocity: FloatArray, compression: FloatArray
    ) -> tuple[FloatArray, float]:
        """Return velocities and time once no pair closes any more."""
        time = first_touch = 0.0
        touched = False
        while True:
            closing = velocity[:-1] - velocity[1:]
            coming = closing > STILL
            if not coming.any():
                return velocity, time - first_touch
            waits = np.maximum(-compression[coming], 0.0) / closing[coming]
            compression = compression + waits.min() * closing
            time += float(waits.min())
            if not touched:
                first_touch, touched = time, True
            velocity, compression, took = self._contact(velocity, compression)
            time += took

    def _contact(
        self, velocity: FloatArray, compression: FloatArray
    ) -> tuple[FloatArray, FloatArray, float]:
        """Return the state after all pairs are open again, and the time it took."""
        from scipy.integrate import solve_ivp

        count = len(self.mass)

        def pressed(_: float, state: FloatArray) -> float:
            return float(state[count:].max() - TOUCH)

        pressed.terminal = True  # type: ignore[attr-defined]
        pressed.direction = -1  # type: ignore[attr-defined]
        solution = solve_ivp(
            self._rates,
            (0.0, LONGEST),
            np.concatenate((velocity, compression)),
            method="DOP853",
            rtol=self.rtol,
            atol=1e-2 * self.rtol,
            first_step=1e-3,
            events=pressed,
        )
        if solution.status != 1:
            raise ChainError(f"the balls do not separate: {solution.message}")
        end = solution.y[:, -1]
        return end[:count], end[count:], float(solution.t[-1])

    def _rates(self, _: float, state: FloatArray) -> FloatArray:
        """Return the rates of velocities and compressions."""
        count = len(self.mass)
        velocity, compression = state[:count], state[count:]
        closing = velocity[:-1] - velocity[1:]
        force = self.stiffness * np.maximum(compression, 0.0) ** 1.5
        if self.dissipation == "hunt-crossley":
            force = force * np.maximum(1 + self.damping * closing, 0.0)
        push = np.zeros(count)
        push[:-1] -= force
        push[1:] += force
        if self.dissipation == "bistiffness":
            closing = self._expansion(closing, compression)
        return np.concatenate((push / self.mass, closing))

    def _expansion(self, closing: FloatArray, compression: FloatArray) -> FloatArray:
        """Return the rates of the virtual compressions of the bi-stiffness law."""
        expanding = np.where(compression > 0, closing / self.restitution**2, 0.0)
        virtual = (closing < 0) & (compression > -EXPANDED)
        return np.where(virtual, expanding, closing)


def _check(
    masses: Sequence[float],
    radii: Sequence[float],
    gap: float | Sequence[float],
    n_incoming: int,
    speed: float,
    restitution: float,
    dissipation: Dissipation | None,
    rtol: float,
) -> None:
    """Raise if an argument of `first_impact` is out of range."""
    if len(masses) < 2 or len(masses) != len(radii):
        raise ChainError(
            f"{len(masses)} masses and {len(radii)} radii; allowed: as many, 2 or more"
        )
    if min(masses) <= 0 or min(radii) <= 0 or speed <= 0:
        raise ChainError("masses, radii and speed must be above 0")
    gaps = np.atleast_1d(np.asarray(gap, dtype=float))
    if gaps.shape not in ((1,), (len(masses) - 1,)) or not (gaps >= 0).all():
        raise ChainError(
            f"gap = {gap}; allowed: one number of at least 0, or {len(masses) - 1}"
        )
    if not 1 <= n_incoming < len(masses):
        raise ChainError(f"n_incoming = {n_incoming}; allowed: 1 to {len(masses) - 1}")
    if not 0 < restitution <= 1:
        raise ChainError(f"restitution = {restitution}; allowed: above 0 to 1")
    if dissipation not in (None, "bistiffness", "hunt-crossley"):
        raise ChainError(
            f"dissipation = {dissipation!r}; allowed: None, 'bistiffness' and "
            "'hunt-crossley'"
        )
    if restitution < 1 and dissipation is None:
        raise ChainError(
            f"restitution = {restitution} needs dissipation 'bistiffness' or "
            "'hunt-crossley': they differ by several per cent of the impact speed"
        )
    if not 1e-13 <= rtol <= 1e-3:
        raise ChainError(f"rtol = {rtol}; allowed: 1e-13 to 1e-3")
