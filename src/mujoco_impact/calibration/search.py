"""The evolutionary search on the grid: differential evolution over grid indices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_impact.calibration.grid import Axis
from mujoco_impact.calibration.objective import Candidates, Objective, candidates_of
from mujoco_impact.calibration.shots import Array

POPULATION = 15
"""Candidates per parameter that is sought."""

CONVERGED = 1e-6
"""Spread of the population's evaluation values, over their mean, that ends a search."""


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        values: Value of each axis, on the grid, shape (axes,).
        evaluation: Evaluation value there [kg m/s].
        generations: Generations it took.
        converged: Whether the population agreed before the limit of generations.
    """

    values: Array
    evaluation: float
    generations: int
    converged: bool


@dataclass(frozen=True)
class GridEvaluation:
    """The evaluation value as a function of grid indices.

    Attributes:
        objective: The evaluation value of candidates.
        axes: All axes, those with a single value included.
    """

    objective: Objective
    axes: Sequence[Axis]

    @property
    def sought(self) -> list[int]:
        """Positions of the axes with more than one value."""
        return [i for i, axis in enumerate(self.axes) if axis.points > 1]

    def values(self, index: Array) -> Array:
        """Returns the values at indices of the sought axes, (candidates, axes)."""
        table = np.empty((len(index), len(self.axes)))
        table[:] = [axis.low for axis in self.axes]
        for column, i in enumerate(self.sought):
            table[:, i] = self.axes[i].values(np.rint(index[:, column]))
        return table

    def candidates(self, index: Array) -> Candidates:
        """Returns the candidates at indices of the sought axes."""
        names = tuple(axis.name for axis in self.axes)
        return candidates_of(self.values(index), names)

    def population(self, index: Array) -> Array:
        """Returns the evaluation of columns of indices, shape (sought, candidates)."""
        return self.objective(self.candidates(index.T))


def search(
    evaluation: GridEvaluation,
    *,
    seed: int = 0,
    generations: int = 1000,
    progress: Callable[[int, float], None] | None = None,
) -> Found:
    """Returns the best candidate on the grid by differential evolution.

    Args:
        evaluation: What to make small.
        seed: Seed of the search; the same seed gives the same result.
        generations: Most generations.
        progress: Called after each generation with its number and the best value.
    """
    from scipy.optimize import differential_evolution

    best = np.inf
    done = 0

    def callback(intermediate_result: Any) -> None:
        nonlocal best, done
        done += 1
        best = float(intermediate_result.fun)
        if progress is not None:
            progress(done, best)

    bounds = [(0, evaluation.axes[i].points - 1) for i in evaluation.sought]
    result = differential_evolution(
        # a whole generation as one array
        evaluation.population,
        bounds,
        integrality=[True] * len(bounds),
        popsize=POPULATION,
        maxiter=generations,
        tol=CONVERGED,
        atol=0.0,
        seed=seed,
        polish=False,
        updating="deferred",
        vectorized=True,
        callback=callback,
    )
    return Found(
        values=evaluation.values(result.x[np.newaxis])[0],
        evaluation=float(result.fun),
        generations=int(result.nit),
        converged=bool(result.success),
    )
