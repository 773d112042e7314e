"""The evaluation value in the combinations of parameters that it depends on.

The normal impulses are P_k = a_k (2/pi) (W_0 p + b) with a_k = alpha_k S_h and
b = kappa S_w 1e-3: S_h and the alpha_k appear in no other way, E in none. In (a, b) the
minimum is found by reweighted least squares, for many weightings of the shots at once;
friction, which is small, follows by iteration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mujoco_impact.calibration.objective import Objective
from mujoco_impact.calibration.shots import Array

MOST_ITERATIONS = 200

SETTLED = 1e-9
"""Relative change of the parameters that ends the iteration."""

SMALLEST_RESIDUAL = 1e-7
"""Residuals below it, over the momentum that comes in, weigh the same: a perfect fit
would weigh without bound."""

RIDGE = 1e-9
"""Relative, on the last unknown; keeps b where shots of one speed do not tell it."""


@dataclass(frozen=True)
class Combinations:
    """The combinations of one or of many fits.

    Attributes:
        a: alpha_k S_h [N s/(kg m)], shape (fits, contacts).
        b: kappa S_w 1e-3 [kg m], shape (fits,).
        evaluation: Weighted evaluation value [kg m/s], shape (fits,).
    """

    a: Array
    b: Array
    evaluation: Array


@dataclass(frozen=True)
class Refit:
    """Fits of (a, b) that start at one point.

    Attributes:
        objective: The evaluation value.
        a: Start of a, shape (contacts,).
        b: Start of b.
        bounds: Smallest and largest b.
    """

    objective: Objective
    a: Array
    b: float
    bounds: tuple[float, float]

    def __call__(
        self, weights: Array, mu_s: Array, mu_d: Array, fixed_b: Array | None = None
    ) -> Combinations:
        """Returns one fit per row of the arguments.

        Args:
            weights: Weight of each shot, shape (fits, shots).
            mu_s: Static friction factor, shape (fits,).
            mu_d: Dynamic friction factor, shape (fits,).
            fixed_b: Values that b is held at, shape (fits,).
        """
        fits = len(weights)
        a = np.tile(self.a, (fits, 1))
        b = np.full(fits, self.b) if fixed_b is None else np.array(fixed_b)
        for _ in range(MOST_ITERATIONS):
            before = a
            a, b = self._step(weights, mu_s, mu_d, a, b, fixed_b is not None)
            change = np.abs(a - before).max(axis=1) / np.abs(a).max(axis=1)
            if (change < SETTLED).all():
                break
        residual = self._residuals(a, b, mu_s, mu_d)
        error = np.linalg.norm(residual, axis=-1).sum(axis=-1)
        return Combinations(a, b, (weights * error).sum(axis=1) / weights.sum(axis=1))

    def _width(self, b: Array) -> Array:
        """Returns (2/pi) (W_0 p + b), shape (fits, shots)."""
        width: Array = (
            2 / np.pi * (self.objective.w0 * self.objective.momentum + b[:, np.newaxis])
        )
        return width

    def normal_impulses(self, a: Array, b: Array) -> Array:
        """Returns P_k [N s], shape (fits, shots, contacts)."""
        return a[:, np.newaxis, :] * self._width(b)[:, :, np.newaxis]

    def _residuals(self, a: Array, b: Array, mu_s: Array, mu_d: Array) -> Array:
        """Returns m dv - P, shape (fits, shots, balls, 3)."""
        P = self.normal_impulses(a, b)
        Q = self.objective.friction(P, mu_s, mu_d)
        return self.objective.momentum_change - self.objective.on_balls(P, Q)

    def _unit_impulses(self) -> Array:
        """Returns what P_k = 1 does to the balls, (contacts, shots, balls, 3)."""
        contacts = len(self.a)
        shape = (contacts, len(self.objective.momentum), contacts)
        unit = np.broadcast_to(np.eye(contacts)[:, np.newaxis, :], shape)
        return self.objective.on_balls(unit, np.zeros(shape))

    def _step(
        self, weights: Array, mu_s: Array, mu_d: Array, a: Array, b: Array, hold: bool
    ) -> tuple[Array, Array]:
        """Returns the next (a, b) of least squares weighted by 1/|residual|."""
        residual = self._residuals(a, b, mu_s, mu_d)
        smallest = SMALLEST_RESIDUAL * self.objective.momentum.mean()
        length = np.maximum(np.linalg.norm(residual, axis=-1), smallest)
        weight = weights[:, :, np.newaxis] / length
        unit = self._unit_impulses()
        impulse = np.einsum("fk,ksnx->fsnx", a, unit)
        width = self._width(b)[:, :, np.newaxis, np.newaxis]
        if not hold:
            by_a = width[:, np.newaxis] * unit
            slopes = np.concatenate((by_a, 2 / np.pi * impulse[:, np.newaxis]), axis=1)
            step = _least_squares(slopes, residual, weight)[:, -1]
            b = np.clip(b + step, *self.bounds)
        # what is left for the normal impulses, friction as it was; linear in a
        rest = residual + width * impulse
        slopes = self._width(b)[:, np.newaxis, :, np.newaxis, np.newaxis] * unit
        return _least_squares(slopes, rest, weight), b


def _least_squares(slopes: Array, right: Array, weight: Array) -> Array:
    """Returns x that makes the weighted |right - slopes x|^2 least, (fits, unknowns).

    Args:
        slopes: Shape (fits, unknowns, shots, balls, 3).
        right: Shape (fits, shots, balls, 3).
        weight: Shape (fits, shots, balls).
    """
    weighted = slopes * weight[:, np.newaxis, ..., np.newaxis]
    matrix = np.einsum("fisnx,fjsnx->fij", weighted, slopes)
    vector = np.einsum("fisnx,fsnx->fi", weighted, right)
    last = matrix.shape[1] - 1
    matrix[:, last, last] *= 1 + RIDGE
    solution: Array = np.linalg.solve(matrix, vector[..., np.newaxis])[..., 0]
    return solution
