"""The unknown parameters and where they are sought: table 1 of Dondo and Noborio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mujoco_impact.calibration.shots import Array
from mujoco_impact.errors import ConfigError


@dataclass(frozen=True)
class Axis:
    """Allowed values of one parameter: low, low + step, ... high.

    Attributes:
        name: Name of the parameter, as the plugin spells it; `alpha_1` and so on.
        low: Smallest value.
        high: Largest value.
        step: Distance of two values.
    """

    name: str
    low: float
    high: float
    step: float

    @property
    def points(self) -> int:
        """Number of allowed values."""
        return round((self.high - self.low) / self.step) + 1

    def values(self, index: npt.ArrayLike) -> Array:
        """Returns the values at indices from 0 on, as their decimals read back."""
        values: Array = np.round(self.low + self.step * np.asarray(index), 9)
        return values

    def at(self, value: float) -> Axis:
        """Returns the axis that allows a single value of this one.

        Raises:
            ConfigError: If the value lies outside the range.
        """
        if not self.low <= value <= self.high:
            msg = f"{self.name} = {value}; allowed: {self.low} to {self.high}"
            raise ConfigError(msg)
        return Axis(self.name, value, value, self.step)


TABLE_1 = (
    Axis("sh", 100.0, 250.0, 0.01),
    Axis("sw", 0.001, 2.0, 0.001),
    Axis("e", 0.001, 1.0, 0.001),
    Axis("mu_s", 0.001, 1.0, 0.001),
    Axis("mu_d", 0.001, 1.0, 0.001),
)
"""S_h, S_w, E, mu_s and mu_d."""

TABLE_1_ALPHA = Axis("alpha", 0.001, 1.5, 0.001)
"""Every alpha_k."""


def axes(contacts: int, fixed: Mapping[str, float] | None = None) -> tuple[Axis, ...]:
    """Returns the axes of a row: those of table 1, then alpha_1 to alpha_contacts.

    Args:
        contacts: Number of contacts of the row.
        fixed: Parameters that are given instead of sought, by name.

    Raises:
        ConfigError: If a fixed parameter is unknown or out of range.
    """
    alphas = tuple(
        Axis(f"alpha_{k}", TABLE_1_ALPHA.low, TABLE_1_ALPHA.high, TABLE_1_ALPHA.step)
        for k in range(1, contacts + 1)
    )
    every = (*TABLE_1, *alphas)
    given = dict(fixed or {})
    unknown = sorted(given.keys() - {axis.name for axis in every})
    if unknown:
        known = ", ".join(axis.name for axis in every)
        raise ConfigError(f"unknown parameter {unknown[0]!r} (available: {known})")
    return tuple(
        axis.at(given[axis.name]) if axis.name in given else axis for axis in every
    )
