"""A row of pendulum balls with Hertz contacts: geometry, stiffness, energy.

Conventions: ball i hangs on a massless rigid arm of length L; its angle is 0 at the
bottom and positive towards +x, the direction of the row. All quantities are SI.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mujoco_impact.errors import ImpactError

FloatArray = NDArray[np.float64]


class ChainError(ImpactError, ValueError):
    """The reference cannot be computed for these values."""


class BallLike(Protocol):
    """Anything with a mass and a radius, such as `cradle_models.Ball`."""

    @property
    def mass(self) -> float:
        """Mass [kg]."""

    @property
    def radius(self) -> float:
        """Radius [m]."""


def hertz_stiffness(
    left_radius: float, right_radius: float, young: float, poisson: float
) -> float:
    """Return K of the Hertz force K delta^1.5 between two balls [N/m^1.5].

    K = 4/3 E* sqrt(R*) with E* = young / (2 (1 - poisson^2)) and
    R* = r_1 r_2 / (r_1 + r_2) [Johnson, Contact Mechanics, 4.2].

    Args:
        left_radius: Radius [m].
        right_radius: Radius [m].
        young: Young's modulus of both balls [Pa].
        poisson: Poisson's ratio of both balls.
    """
    modulus = young / (2 * (1 - poisson**2))
    radius = left_radius * right_radius / (left_radius + right_radius)
    return 4 / 3 * modulus * math.sqrt(radius)


def contact_time(reduced_mass: float, stiffness: float, speed: float) -> float:
    """Return how long two free balls touch in an elastic Hertz impact [s].

    Energy, mu v^2 / 2 = mu d'^2 / 2 + 2/5 K d^2.5, gives the largest compression
    d_max and T = 2 (d_max / v) B with B = int_0^1 dx / sqrt(1 - x^2.5)
    = (2/5) sqrt(pi) Gamma(2/5) / Gamma(9/10), hence T = 2.94328 d_max / v.

    Args:
        reduced_mass: mu = m_1 m_2 / (m_1 + m_2) [kg].
        stiffness: K [N/m^1.5].
        speed: Closing speed v [m/s], positive.
    """
    shape = 0.4 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9)
    return 2 * shape * largest_compression(reduced_mass, stiffness, speed) / speed


def largest_compression(reduced_mass: float, stiffness: float, speed: float) -> float:
    """Return the largest compression of two free balls, (5 mu v^2 / 4K)^(2/5) [m].

    Args: see `contact_time`.
    """
    return float((5 * reduced_mass * speed**2 / (4 * stiffness)) ** 0.4)


@dataclass(frozen=True)
class Chain:
    """Balls on massless arms of one length, in a row, with Hertz contacts.

    Attributes:
        masses: Masses, left to right [kg], n of them.
        radii: Radii [m], n of them.
        gaps: Gaps between hanging neighbours [m], n - 1 of them; negative: overlap.
        length: Distance from pivot to centre [m].
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        gravity: Gravity along -z [m/s^2], positive.
    """

    masses: tuple[float, ...]
    radii: tuple[float, ...]
    gaps: tuple[float, ...]
    length: float = 0.3
    young: float = 2e11
    poisson: float = 0.3
    gravity: float = 9.81

    def __post_init__(self) -> None:
        """Check the values."""
        count = len(self.masses)
        if count < 1 or len(self.radii) != count or len(self.gaps) != count - 1:
            raise ChainError(
                f"a chain of {count} masses needs {count} radii and {count - 1} gaps; "
                f"got {len(self.radii)} and {len(self.gaps)}"
            )
        for name in ("masses", "radii", "length", "young", "gravity"):
            values = np.atleast_1d(getattr(self, name))
            if not (np.isfinite(values).all() and (values > 0).all()):
                raise ChainError(
                    f"{name} = {getattr(self, name)}; allowed: finite and > 0"
                )
        if not -1 < self.poisson <= 0.5:
            raise ChainError(f"poisson = {self.poisson}; allowed: -1 to 0.5")
        if not np.isfinite(self.gaps).all():
            raise ChainError(f"gaps = {self.gaps}; allowed: finite [m]")

    @classmethod
    def of(
        cls,
        balls: Sequence[BallLike],
        *,
        gap: float | Sequence[float] = 0.0,
        length: float = 0.3,
        young: float = 2e11,
        poisson: float = 0.3,
        gravity: float = 9.81,
    ) -> Chain:
        """Return the chain of some balls, with one gap for all pairs or one for each.

        Args: see the attributes of `Chain`; `balls` have a mass and a radius.
        """
        pairs = len(balls) - 1
        return cls(
            masses=tuple(float(ball.mass) for ball in balls),
            radii=tuple(float(ball.radius) for ball in balls),
            gaps=tuple(gap) if isinstance(gap, Sequence) else (float(gap),) * pairs,
            length=length,
            young=young,
            poisson=poisson,
            gravity=gravity,
        )

    @property
    def count(self) -> int:
        """Number of balls n."""
        return len(self.masses)

    @cached_property
    def inertia(self) -> FloatArray:
        """Moments about the pivots, m L^2 + 2/5 m r^2 [kg m^2], shape (n,)."""
        mass, radius = np.array(self.masses), np.array(self.radii)
        inertia: FloatArray = mass * self.length**2 + 0.4 * mass * radius**2
        return inertia

    @cached_property
    def weight_torque(self) -> FloatArray:
        """Largest torque of gravity, m g L [N m], shape (n,)."""
        torque: FloatArray = np.array(self.masses) * self.gravity * self.length
        return torque

    @cached_property
    def frequency(self) -> FloatArray:
        """Angular frequency of small swings, sqrt(m g L / I) [rad/s], shape (n,)."""
        return np.sqrt(self.weight_torque / self.inertia)

    @cached_property
    def stiffness(self) -> FloatArray:
        """Hertz stiffness K of each pair [N/m^1.5], shape (n - 1,)."""
        pairs = itertools.pairwise(self.radii)
        return np.array(
            [hertz_stiffness(a, b, self.young, self.poisson) for a, b in pairs]
        )

    @cached_property
    def spacing(self) -> FloatArray:
        """Distances between neighbouring pivots [m], shape (n - 1,)."""
        radii = np.array(self.radii, dtype=float)
        spacing: FloatArray = radii[:-1] + radii[1:] + self._rest_gap
        return spacing

    def separation(self, angles: ArrayLike) -> FloatArray:
        """Return the gap of each pair [m]; negative: compressed.

        Args:
            angles: Angles [rad], shape (..., n).

        Returns:
            Gaps [m], shape (..., n - 1).
        """
        gap, _, _ = self.contacts(angles)
        return gap

    def contacts(self, angles: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the gap of each pair and its derivatives by its two angles.

        With d = b - a, m = (a + b) / 2, chord q = 2 L sin(d/2) and pivots s apart, the
        centres are sqrt(s^2 + 2 s q cos m + q^2) apart. The gap is written as a
        difference from s, so that compressions of 1e-5 m keep their digits.

        Args:
            angles: Angles [rad], shape (..., n).

        Returns:
            Gaps [m] and derivatives by the left and by the right angle [m/rad], each
            of shape (..., n - 1).
        """
        angle = np.asarray(angles, dtype=float)
        half = 0.5 * (angle[..., 1:] - angle[..., :-1])
        mean = 0.5 * (angle[..., 1:] + angle[..., :-1])
        space = self.spacing
        chord = 2 * self.length * np.sin(half)
        lever = space * np.cos(mean)
        excess = chord * (2 * lever + chord)
        distance = np.sqrt(space**2 + excess)
        gap: FloatArray = self._rest_gap + excess / (distance + space)
        by_difference = self.length * np.cos(half) * (lever + chord) / distance
        by_mean = -space * chord * np.sin(mean) / distance
        return gap, 0.5 * by_mean - by_difference, 0.5 * by_mean + by_difference

    @cached_property
    def _rest_gap(self) -> FloatArray:
        return np.array(self.gaps, dtype=float)

    def free_acceleration(self, angles: ArrayLike) -> FloatArray:
        """Return the angular acceleration without contacts [rad/s^2].

        Args:
            angles: Angles [rad], shape (..., n).
        """
        sine = np.sin(np.asarray(angles, dtype=float))
        acceleration: FloatArray = -(self.frequency**2) * sine
        return acceleration

    def mechanical_energy(self, angles: ArrayLike, velocities: ArrayLike) -> FloatArray:
        """Return kinetic and gravity energy together [J], shape (...).

        Zero is the resting row.

        Args:
            angles: Angles [rad], shape (..., n).
            velocities: Angular velocities [rad/s], shape (..., n).
        """
        sine = np.sin(0.5 * np.asarray(angles, dtype=float))
        rate = np.asarray(velocities, dtype=float)
        each = 2 * self.weight_torque * sine**2 + 0.5 * self.inertia * rate**2
        total: FloatArray = each.sum(axis=-1)
        return total

    def energy(self, angles: ArrayLike, velocities: ArrayLike) -> FloatArray:
        """Return the mechanical energy plus that of the compressed contacts [J].

        Args: see `mechanical_energy`.
        """
        compression = np.maximum(-self.separation(angles), 0.0)
        stored: FloatArray = (0.4 * self.stiffness * compression**2.5).sum(axis=-1)
        return self.mechanical_energy(angles, velocities) + stored


def release_state(
    chain: Chain, release: float, released: int
) -> tuple[FloatArray, FloatArray]:
    """Return angles [rad] and velocities [rad/s] of a row about to be let go.

    Args:
        chain: The row.
        release: Angle by which the released balls are lifted towards -x [deg].
        released: Number of balls lifted, counted from the left.
    """
    if not 0 <= release < 180:
        raise ChainError(f"release = {release} deg; allowed: 0 to below 180")
    if not 0 <= released <= chain.count:
        raise ChainError(f"released = {released}; allowed: 0 to {chain.count}")
    angles = np.zeros(chain.count)
    angles[:released] = -math.radians(release)
    return angles, np.zeros(chain.count)
