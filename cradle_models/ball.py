"""Balls and rows of balls: masses [kg], radii [m] and where the centres rest."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from cradle_models.checks import require_positive
from cradle_models.errors import ModelValueError


@dataclass(frozen=True)
class Ball:
    """A solid homogeneous sphere.

    Attributes:
        mass: Mass [kg], positive.
        radius: Radius [m], positive.
    """

    mass: float
    radius: float

    def __post_init__(self) -> None:
        """Check the values."""
        require_positive("Ball.mass [kg]", self.mass)
        require_positive("Ball.radius [m]", self.radius)


#: Ball A, 115 g and 30.0 mm across [Dondo and Noborio, section 4.1].
A = Ball(mass=0.115, radius=0.015)

#: Ball B, 230 g and 38.1 mm across [Dondo and Noborio, section 4.1].
B = Ball(mass=0.230, radius=0.01905)

#: The letters of a pattern.
LETTERS = {"A": A, "B": B}


def balls(pattern: str | Sequence[Ball]) -> tuple[Ball, ...]:
    """Return the balls of a row, left to right.

    Args:
        pattern: A string of the letters A and B (either case), or the balls.

    Raises:
        ModelValueError: The row is empty or holds something that is not a ball.
    """
    if isinstance(pattern, str):
        unknown = sorted(set(pattern.upper()) - set(LETTERS))
        if unknown:
            raise ModelValueError(
                f"pattern {pattern!r} has the unknown letters {unknown}; "
                f"available: {sorted(LETTERS)}"
            )
        found = tuple(LETTERS[letter] for letter in pattern.upper())
    else:
        found = tuple(pattern)
    if not found:
        raise ModelValueError(f"pattern {pattern!r} has no ball; at least 1 is needed")
    for ball in found:
        if not isinstance(ball, Ball):
            raise ModelValueError(f"{ball!r} is not a cradle_models.Ball")
    return found


def gaps(gap: float | Sequence[float], count: int) -> tuple[float, ...]:
    """Return one gap [m] per neighbouring pair of `count` balls.

    Args:
        gap: One gap for all pairs, or one for each; negative: overlap [m].
        count: Number of balls.
    """
    pairs = count - 1
    found = tuple(gap) if isinstance(gap, Sequence) else (float(gap),) * pairs
    if len(found) != pairs:
        raise ModelValueError(
            f"gap has {len(found)} values; {count} balls have {pairs} pairs"
        )
    for value in found:
        if not math.isfinite(value):
            raise ModelValueError(f"gap = {value}; allowed: finite [m]")
    return found


def centres(row: Sequence[Ball], between: Sequence[float]) -> tuple[float, ...]:
    """Return the x of the hanging balls [m], the row centred on x = 0.

    Neighbours are r_i + r_(i+1) + gap_i apart, to the rounding of one addition.
    """
    positions = [0.0]
    for left, right, gap in zip(row, row[1:], between, strict=False):
        spacing = left.radius + right.radius + gap
        if spacing <= 0:
            raise ModelValueError(
                f"gap = {gap} m lets the centres of two balls of radius "
                f"{left.radius} m and {right.radius} m pass each other"
            )
        positions.append(positions[-1] + spacing)
    ends = (positions[0] - row[0].radius, positions[-1] + row[-1].radius)
    middle = (ends[0] + ends[1]) / 2
    return tuple(position - middle for position in positions)
