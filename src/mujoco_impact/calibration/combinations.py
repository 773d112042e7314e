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
"""Relative; keeps b in place where shots of one speed cannot tell it from a."""


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
            step_a, step_b = self._step(weights, mu_s, mu_d, a, b, fixed_b is not None)
            a, b = a + step_a, b + step_b
            change = np.abs(step_a).max(axis=1) / np.abs(a).max(axis=1)
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

    def _slopes(self, a: Array, b: Array) -> Array:
        """Returns dP/d(a, b), shape (fits, contacts + 1, shots, balls, 3)."""
        contacts = a.shape[1]
        unit = np.eye(contacts)[:, np.newaxis, :]
        shots = len(self.objective.momentum)
        unit = np.broadcast_to(unit, (contacts, shots, contacts))
        on_balls = self.objective.on_balls(unit, np.zeros_like(unit))
        by_a = self._width(b)[:, np.newaxis, :, np.newaxis, np.newaxis] * on_balls
        by_b = 2 / np.pi * np.einsum("fk,ksnx->fsnx", a, on_balls)
        return np.concatenate((by_a, by_b[:, np.newaxis]), axis=1)

    def _step(
        self, weights: Array, mu_s: Array, mu_d: Array, a: Array, b: Array, hold: bool
    ) -> tuple[Array, Array]:
        """Returns one step of least squares weighted by 1/|residual|, in bounds."""
        residual = self._residuals(a, b, mu_s, mu_d)
        smallest = SMALLEST_RESIDUAL * self.objective.momentum.mean()
        length = np.maximum(np.linalg.norm(residual, axis=-1), smallest)
        slopes = self._slopes(a, b)
        weighted = slopes * (weights[:, :, np.newaxis] / length)[:, None, ..., None]
        matrix = np.einsum("fisnx,fjsnx->fij", weighted, slopes)
        right = np.einsum("fisnx,fsnx->fi", weighted, residual)
        matrix[:, -1, -1] *= 1 + RIDGE
        step_b = np.zeros(len(b))
        if not hold:
            free = np.linalg.solve(matrix, right[..., np.newaxis])[:, -1, 0]
            step_b = np.clip(b + free, *self.bounds) - b
        right_a = right[:, :-1] - matrix[:, :-1, -1] * step_b[:, np.newaxis]
        step_a = np.linalg.solve(matrix[:, :-1, :-1], right_a[..., np.newaxis])
        return step_a[..., 0], step_b
