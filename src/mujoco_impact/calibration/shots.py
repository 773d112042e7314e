"""Measured shots of a row of balls: what a calibration works on.

One shot is one impact of a row, filmed: the velocities of all balls before and after
it, and the direction of every contact. All shots of one set are of the same balls.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from mujoco_impact.errors import ShotsError

Array: TypeAlias = npt.NDArray[np.float64]

MOST_BALLS = 100
"""Longest row of a file; a calibration fits a number for every contact."""

UNIT_TOLERANCE = 1e-3
"""How far the length of a direction may be from 1: three printed decimals."""


@dataclasses.dataclass(frozen=True, eq=False)
class Shots:
    """Shots of one row of n balls, ball 1 coming in.

    Any right-handed frame will do, as long as velocities and directions share it.

    Attributes:
        masses: Masses [kg], shape (n,).
        before: Velocities of the centres just before the impact [m/s], shape (shots,
            n, 3).
        after: Velocities just after the impact [m/s], shape (shots, n, 3).
        directions: Unit vectors from ball k to ball k + 1 at the impact, shape (shots,
            n - 1, 3).
    """

    masses: Array
    before: Array
    after: Array
    directions: Array

    def __post_init__(self) -> None:
        """Checks shapes and values."""
        balls = len(self.masses)
        shape = (len(self.before), balls, 3)
        if balls < 2 or self.before.shape != shape or self.after.shape != shape:
            msg = (
                f"shots of {balls} balls need velocities (shots, n, 3), n >= 2; "
                f"got {self.before.shape} before and {self.after.shape} after"
            )
            raise ShotsError(msg)
        if self.directions.shape != (len(self.before), balls - 1, 3):
            msg = (
                f"{balls} balls need directions of shape ({len(self.before)}, "
                f"{balls - 1}, 3); got {self.directions.shape}"
            )
            raise ShotsError(msg)
        if self.count == 0:
            raise ShotsError("there are no shots; 1 or more are needed")
        self._check_values()

    def _check_values(self) -> None:
        """Raises ShotsError for the first shot that cannot be one."""
        if not (np.isfinite(self.masses) & (self.masses > 0)).all():
            raise ShotsError(
                f"masses = {self.masses}; allowed: finite numbers > 0 [kg]"
            )
        for name in ("before", "after", "directions"):
            bad = ~np.isfinite(getattr(self, name)).all(axis=(1, 2))
            if bad.any():
                msg = f"shot {_first(bad)}: {name} has a number that is not finite"
                raise ShotsError(msg)
        length = np.linalg.norm(self.directions, axis=2)
        wrong = np.abs(length - 1) > UNIT_TOLERANCE
        if wrong.any():
            shot, contact = np.argwhere(wrong)[0]
            msg = (
                f"shot {shot + 1}: the direction of contact {contact + 1} has length "
                f"{length[shot, contact]:.6g}; allowed: 1 within {UNIT_TOLERANCE}"
            )
            raise ShotsError(msg)
        receding = self.closing_speeds[:, 0] <= 0
        if receding.any():
            shot = _first(receding)
            msg = (
                f"shot {shot}: ball 1 does not close in on ball 2 (closing speed "
                f"{self.closing_speeds[shot - 1, 0]:.6g} m/s along the direction of "
                "contact 1, allowed: > 0)"
            )
            raise ShotsError(msg)

    @property
    def count(self) -> int:
        """Number of shots."""
        return len(self.before)

    @property
    def contacts(self) -> int:
        """Number of contacts, n - 1."""
        return len(self.masses) - 1

    @property
    def momentum_change(self) -> Array:
        """Change of momentum m dv of every ball [kg m/s], shape (shots, n, 3)."""
        change: Array = self.masses[:, np.newaxis] * (self.after - self.before)
        return change

    @property
    def relative_velocities(self) -> Array:
        """Velocities u = v_k - v_(k+1) before [m/s], shape (shots, n - 1, 3)."""
        u: Array = self.before[:, :-1] - self.before[:, 1:]
        return u

    @property
    def closing_speeds(self) -> Array:
        """Speeds u_z along contacts [m/s], > 0: approaching, (shots, n - 1)."""
        u_z: Array = (self.relative_velocities * self.directions).sum(axis=2)
        return u_z

    @property
    def momentum(self) -> Array:
        """Momentum p = m_1 u_z of the ball that comes in [kg m/s], (shots,)."""
        p: Array = self.masses[0] * self.closing_speeds[:, 0]
        return p

    @property
    def imbalance(self) -> Array:
        """Sum of m dv over the balls along contact 1, over p, shape (shots,).

        Zero if momentum is conserved; measurement errors make it a few per cent. Larger
        values mean that the rows are not those of one impact.
        """
        total = self.momentum_change.sum(axis=1)
        share: Array = (total * self.directions[:, 0]).sum(axis=1) / self.momentum
        return share

    def subset(self, shots: Sequence[int] | npt.NDArray[np.intp]) -> Shots:
        """Returns some of the shots, by their number from 0."""
        index = np.asarray(shots, dtype=np.intp)
        return dataclasses.replace(
            self,
            before=self.before[index],
            after=self.after[index],
            directions=self.directions[index],
        )


def _first(bad: npt.NDArray[np.bool_]) -> int:
    """Returns the number, from 1, of the first shot that is bad."""
    return int(np.flatnonzero(bad)[0]) + 1
