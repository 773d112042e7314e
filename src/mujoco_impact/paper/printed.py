"""What Dondo and Noborio print: tables 3 to 11, digit by digit.

K. Dondo and H. Noborio, *Experiment and evaluation of multi-collision movement model
using Newton's Cradle*, Osaka Electro-Communication University. `tables.csv` holds
tables 4 to 11 (m dv and P, means of ten shots), `parameters.csv` table 3.

Frame of the paper: x vertical, y lateral, z along the row, ball 1 coming in towards +z.
The printed changes m dv_z of ball 1 are therefore negative.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
import numpy.typing as npt

import cradle_models
from mujoco_impact.calibration.parameters import Parameters

Array = npt.NDArray[np.float64]

STRAY_PATTERN = "AAB"
"""Pattern of the P table without a caption, printed after table 7: its P_z follow from
the Hertz impact of A -> A - B within 5 %; the next best, A -> B - B, is 8 % off."""

MEASURED = "AAA"
"""Pattern of table 4, from which all others but one copy their velocity changes."""


@dataclass(frozen=True, eq=False)
class Printed:
    """One pattern as printed.

    Attributes:
        pattern: Letters of the balls, ball 1 coming in.
        table: Number of its table.
        evaluation: Evaluation value of table 3 [kg m/s].
        parameters: Parameters of table 3, with the project's W_0 and kappa.
        change: m dv [kg m/s], shape (3, 3): ball, axis.
        impulse: P [N s], shape (3, 3); None: not printed.
        stray: Whether the P table has no caption and was assigned by its numbers.
    """

    pattern: str
    table: int
    evaluation: float
    parameters: Parameters
    change: Array
    impulse: Array | None
    stray: bool

    @property
    def masses(self) -> Array:
        """Masses [kg], shape (3,)."""
        return np.array([ball.mass for ball in cradle_models.balls(self.pattern)])

    @property
    def imbalance(self) -> float:
        """Sum of m dv_z over the balls, over |m dv_z| of ball 1: 0 if conserved."""
        return float(self.change[:, 2].sum() / abs(self.change[0, 2]))

    @property
    def copied(self) -> tuple[bool, ...]:
        """For each ball: whether its row is the velocity change of table 4."""
        if self.pattern == MEASURED:
            return (False, False, False)
        source = printed(MEASURED)
        copy = self.masses[:, np.newaxis] * (source.change / source.masses[:, None])
        # printed to 1e-6, and twice a rounded number is off by another unit
        distance = np.abs(self.change - copy).max(axis=1)
        return tuple(row <= 1.01e-6 for row in distance.tolist())

    def evaluations(self) -> tuple[float, float] | None:
        """Returns sum |m dv - P| of the printed means, by two norms [kg m/s].

        The mean of lengths is at least the length of the mean, so this is a lower bound
        of what the authors' program computed from the same shots. First the sum of
        lengths of vectors, then the sum of all components.
        """
        if self.impulse is None:
            return None
        residual = self.change - self.impulse
        lengths = np.linalg.norm(residual, axis=1)
        return float(lengths.sum()), float(np.abs(residual).sum())


@cache
def printed(pattern: str) -> Printed:
    """Returns what is printed of a pattern, such as "AAB"."""
    (row,) = (row for row in _rows("parameters.csv") if row["pattern"] == pattern)
    numbers = {key: float(value) for key, value in row.items() if key != "pattern"}
    alpha = (numbers.pop("alpha_1"), numbers.pop("alpha_2"))
    evaluation = numbers.pop("evaluation")
    mine = [row for row in _rows("tables.csv") if row["pattern"] == pattern]
    stray = pattern == STRAY_PATTERN
    P = [row for row in mine if row["quantity"] == "P"]
    if stray:
        P = [row for row in _rows("tables.csv") if row["table"] == "stray"]
    return Printed(
        pattern=pattern,
        table=int(mine[0]["table"]),
        evaluation=evaluation,
        parameters=Parameters(alpha=alpha, **numbers),
        change=_vectors(row for row in mine if row["quantity"] == "m dv"),
        impulse=_vectors(iter(P)) if P else None,
        stray=stray,
    )


def _vectors(rows: Iterator[dict[str, str]]) -> Array:
    """Returns the x, y, z of rows, shape (rows, 3)."""
    return np.array([[float(row[axis]) for axis in "xyz"] for row in rows])


@cache
def _rows(name: str) -> tuple[dict[str, str], ...]:
    """Returns the rows of a data file of this package."""
    text = files("mujoco_impact.paper").joinpath(name).read_text(encoding="utf-8")
    return tuple(csv.DictReader(text.splitlines()))
