"""What the shots determine, and how well.

* Combinations that the evaluation value depends on have an interval: the spread of fits
  to resampled shots (bootstrap), widened by Student's t for the number of shots and by
  one step of the grid that the parameters lie on.
* A single parameter has the range in which the evaluation value, all other parameters
  refitted, stays as good as that of 95 % of these fits (profile).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mujoco_impact.calibration.combinations import Combinations, Refit
from mujoco_impact.calibration.grid import Axis
from mujoco_impact.calibration.objective import Objective
from mujoco_impact.calibration.parameters import Parameters
from mujoco_impact.calibration.shots import Array

LEVEL = 0.95
"""Confidence of intervals and ranges."""

RESAMPLES = 300

FEWEST_SHOTS = 4
"""Fewer shots have no spread to speak of."""

PROFILE_POINTS = 61
FRICTION_POINTS = 25


@dataclass(frozen=True)
class Interval:
    """A combination of parameters that the shots determine.

    Attributes:
        name: The combination.
        unit: Its unit.
        value: Its value.
        low: Lower end of the interval of confidence `LEVEL`.
        high: Upper end.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Range:
    """Values of a single parameter that fit as well as the one found.

    Attributes:
        name: The parameter.
        value: The value found.
        low: Smallest value that fits as well.
        high: Largest value that fits as well.
        note: Why it is what it is.
    """

    name: str
    value: float
    low: float
    high: float
    note: str


@dataclass(frozen=True)
class Identifiability:
    """What the shots determine.

    Attributes:
        combinations: Intervals of what they determine.
        ranges: Ranges of the single parameters.
        best: Evaluation value of the best fit off the grid [kg m/s].
    """

    combinations: tuple[Interval, ...]
    ranges: tuple[Range, ...]
    best: float


def identify(
    objective: Objective, found: Parameters, axes: Sequence[Axis], *, seed: int = 0
) -> Identifiability | None:
    """Returns what the shots determine, or None for fewer than `FEWEST_SHOTS`.

    Args:
        objective: The evaluation value on the shots.
        found: The parameters that were found.
        axes: Where they were sought.
        seed: Seed of the resampling.
    """
    shots = objective.shots.count
    if shots < FEWEST_SHOTS:
        return None
    study = _Study(objective, found, {axis.name: axis for axis in axes})
    random = np.random.default_rng(seed)
    weights = random.multinomial(shots, np.full(shots, 1 / shots), size=RESAMPLES)
    resampled = study.refit(weights.astype(float), *study.friction(RESAMPLES))
    return Identifiability(
        combinations=study.intervals(resampled),
        ranges=study.ranges(study.bound(resampled)),
        best=float(study.best.evaluation[0]),
    )


class _Study:
    """The fits around the parameters that were found."""

    def __init__(
        self, objective: Objective, found: Parameters, axes: dict[str, Axis]
    ) -> None:
        self._objective = objective
        self._found = found
        self._axes = axes
        unit = objective.kappa * 1e-3
        self._unit = unit
        self._a = a = found.sh * np.array(found.alpha)
        bounds = (axes["sw"].low * unit, axes["sw"].high * unit)
        self.refit = Refit(objective, a, found.sw * unit, bounds)
        self._even = np.ones((1, objective.shots.count))
        self.best: Combinations = self.refit(self._even, *self.friction(1))

    def friction(self, fits: int) -> tuple[Array, Array]:
        """Returns the friction factors found, once per fit."""
        return np.full(fits, self._found.mu_s), np.full(fits, self._found.mu_d)

    def intervals(self, resampled: Combinations) -> tuple[Interval, ...]:
        """Returns the intervals of alpha_k S_h, alpha_(k+1)/alpha_k and P_1/p."""
        from scipy.stats import t as student

        shots = self._objective.shots.count
        # resampling n shots spreads by (n - 1)/n of the variance of the estimate
        widening = float(student.ppf((1 + LEVEL) / 2, shots - 1))
        widening *= math.sqrt(shots / (shots - 1))
        at_found = self._quantities(*self._on_grid())
        spread = self._quantities(resampled.a, resampled.b)
        intervals = []
        for (name, unit), value in at_found.items():
            at = float(value[0])
            half = widening * float(spread[name, unit].std(ddof=1)) + at * self._grain()
            intervals.append(Interval(name, unit, at, at - half, at + half))
        return tuple(intervals)

    def _grain(self) -> float:
        """Returns one step of the grid in S_h, S_w and every alpha_k, relative."""
        found, axes = self._found, self._axes
        alphas = [axis for name, axis in axes.items() if name.startswith("alpha")]
        alpha = max(
            axis.step / value for axis, value in zip(alphas, found.alpha, strict=True)
        )
        width = self._unit * found.sw + found.w0 * float(self._objective.momentum.min())
        return alpha + axes["sh"].step / found.sh + self._unit * axes["sw"].step / width

    def _on_grid(self) -> tuple[Array, Array]:
        """Returns a and b of the parameters found, for one fit."""
        found = self._found
        return np.atleast_2d(self._a), np.array([found.sw * self._unit])

    def _quantities(self, a: Array, b: Array) -> dict[tuple[str, str], Array]:
        """Returns the combinations and their units."""
        contacts = range(1, a.shape[1] + 1)
        momentum = float(self._objective.momentum.mean())
        share = 2 / np.pi * a[:, 0] * (self._objective.w0 + b / momentum)
        return (
            {(f"alpha_{k} S_h", "N s/(kg m)"): a[:, k - 1] for k in contacts}
            | {(f"alpha_{k + 1}/alpha_{k}", "-"): a[:, k] / a[:, k - 1]
               for k in contacts[:-1]}
            | {("P_1/p at the mean p", "-"): share}
        )  # fmt: skip

    def bound(self, resampled: Combinations) -> float:
        """Returns the evaluation value that still counts as as good."""
        candidates = self._at(resampled.a, resampled.b)
        at_found = self._at(*self._on_grid())
        return max(float(np.quantile(candidates, LEVEL)), float(at_found[0]))

    def _at(self, a: Array, b: Array) -> Array:
        """Returns the evaluation values of combinations on the shots as they are."""
        P = self.refit.normal_impulses(a, b)
        Q = self._objective.friction(P, *self.friction(len(a)))
        on_balls = self._objective.on_balls(P, Q)
        value: Array = self._objective.errors(on_balls).mean(axis=1)
        return value

    def ranges(self, bound: float) -> tuple[Range, ...]:
        """Returns the range of every parameter."""
        e, found = self._axes["e"], self._found
        # α_k = a_k / S_h must stay on the grid
        alphas = [axis for name, axis in self._axes.items() if name.startswith("alpha")]
        sh = self._axes["sh"]
        pairs = list(zip(self._a.tolist(), alphas, strict=True))
        low = max([sh.low, *(a / axis.high for a, axis in pairs)])
        high = min([sh.high, *(a / axis.low for a, axis in pairs)])
        gauge = "only alpha_k S_h counts"
        return (
            Range("sh", found.sh, low, high, gauge),
            self._width_range(bound),
            Range("e", found.e, e.low, e.high, "the impulses do not depend on it"),
            *self._friction_ranges(bound),
            *(Range(axis.name, a / found.sh, a / high, a / low, gauge)
              for a, axis in pairs),
        )  # fmt: skip

    def _width_range(self, bound: float) -> Range:
        """Returns the range of S_w."""
        axis = self._axes["sw"]
        values = np.union1d(
            np.linspace(axis.low, axis.high, PROFILE_POINTS), [self._found.sw]
        )
        weights = np.repeat(self._even, len(values), axis=0)
        fits = self.refit(
            weights, *self.friction(len(values)), fixed_b=values * self._unit
        )
        return _range(self._found, "sw", values, fits.evaluation, bound, "")

    def _friction_ranges(self, bound: float) -> tuple[Range, Range]:
        """Returns the ranges of mu_s and mu_d, each with the other one free."""
        grids = [
            np.union1d(np.geomspace(axis.low, axis.high, FRICTION_POINTS), [value])
            for axis, value in (
                (self._axes["mu_s"], self._found.mu_s),
                (self._axes["mu_d"], self._found.mu_d),
            )
        ]
        mu_s, mu_d = (grid.ravel() for grid in np.meshgrid(*grids, indexing="ij"))
        fits = self.refit(np.repeat(self._even, len(mu_s), axis=0), mu_s, mu_d)
        table = fits.evaluation.reshape(len(grids[0]), len(grids[1]))
        note = "acts only on slip"
        return (
            _range(self._found, "mu_s", grids[0], table.min(axis=1), bound, note),
            _range(self._found, "mu_d", grids[1], table.min(axis=0), bound, note),
        )


def _range(
    found: Parameters, name: str, values: Array, profile: Array, bound: float, note: str
) -> Range:
    """Returns the values whose profile is within the bound; the one found is."""
    value = float(getattr(found, name))
    good = [*values[profile <= bound].tolist(), value]
    return Range(name, value, min(good), max(good), note)
