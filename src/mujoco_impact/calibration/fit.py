"""Calibration: from measured shots to the parameters of the calibrated law."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

import numpy as np

from mujoco_impact.calibration.grid import Axis, axes
from mujoco_impact.calibration.identifiability import Identifiability, identify
from mujoco_impact.calibration.objective import (
    DEFAULT_KAPPA,
    DEFAULT_W0,
    Objective,
    candidates_of,
)
from mujoco_impact.calibration.parameters import Parameters, write_parameters
from mujoco_impact.calibration.search import Found, GridEvaluation, search
from mujoco_impact.calibration.shots import Array, Shots
from mujoco_impact.calibration.shots_file import read_shots
from mujoco_impact.errors import ConfigError
from mujoco_impact.executors import in_order

FOLDS = 5
"""Parts of the shots that are held out in turn."""

Progress = Callable[[str], None]
"""Told in a few words what is going on."""


@dataclasses.dataclass(frozen=True)
class Calibration:
    """What a calibration found, and what it is worth.

    Attributes:
        parameters: The parameters, on the grid of table 1.
        evaluation: Evaluation value on all shots [kg m/s].
        held_out: The same on shots that were held out of the search, averaged over the
            shots; None if there was nothing to hold out.
        scale: What the evaluation value would be without any impulse [kg m/s].
        identifiability: What the shots determine; None if they are too few.
        shots: Number of shots.
        imbalance: Largest sum of m dv over the balls of a shot, over the momentum that
            comes in: how badly the data break the conservation of momentum.
        generations: Generations of the search.
        converged: Whether the search ended before its limit.
    """

    parameters: Parameters
    evaluation: float
    held_out: float | None
    scale: float
    identifiability: Identifiability | None
    shots: int
    imbalance: float
    generations: int
    converged: bool

    @property
    def settings(self) -> dict[str, Any]:
        """Settings for `attach(scene, law="calibrated", **settings)`."""
        return self.parameters.settings

    def to_dict(self) -> dict[str, Any]:
        """Returns everything but the parameters as plain values for JSON."""
        document = dataclasses.asdict(self)
        del document["parameters"]
        return document

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes a file for `mujoco-impact run MODEL --params FILE`."""
        return write_parameters(self.parameters, path, calibration=self.to_dict())


def calibrate(
    shots: Shots | str | os.PathLike[str],
    *,
    fixed: Mapping[str, float] | None = None,
    w0: float = DEFAULT_W0,
    kappa: float = DEFAULT_KAPPA,
    folds: int = FOLDS,
    seed: int = 0,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Calibration:
    """Finds the parameters of the calibrated law that fit measured shots.

    Args:
        shots: The shots, or a CSV file of them (see `calibration.shots_file`).
        fixed: Parameters that are given instead of sought, such as `{"e": 1.0}`.
        w0: W_0 of equation (6) [s].
        kappa: Unit factor of the S_w term of equation (6).
        folds: Parts of the shots that are held out in turn; 0: none.
        seed: Seed of the search and of the resampling.
        executor: Where the searches are done, one on all shots and one for each fold;
            see `executors.in_order`. By default in this process: to start another one
            takes as long as a search. The result does not depend on it.
        progress: Told what is going on.

    Returns:
        The parameters, with what they are worth.

    Raises:
        ShotsError: If the shots cannot be read or used.
        ConfigError: If an option is out of range.
    """
    measured = shots if isinstance(shots, Shots) else read_shots(shots)
    if not (np.isfinite([w0, kappa]).all() and w0 > 0 and kappa >= 0):
        msg = f"w0 = {w0}, kappa = {kappa}; allowed: w0 > 0 [s], kappa >= 0"
        raise ConfigError(msg)
    if folds < 0 or folds == 1:
        msg = f"folds = {folds}; allowed: 0 (hold out nothing) or 2 and more"
        raise ConfigError(msg)
    grid = axes(measured.contacts, fixed)
    tell = progress or (lambda _: None)
    objective = Objective(measured, w0=w0, kappa=kappa)

    parts = _held_out_parts(measured, min(folds, measured.count))
    rests = (dataclasses.replace(objective, shots=rest) for _, rest in parts)
    found, *on_rests = _searches([objective, *rests], grid, seed, executor, tell)
    parameters = _parameters(found.values, grid, objective)
    held_out = _held_out(objective, grid, [held for held, _ in parts], on_rests)
    tell("what the shots determine")
    change = np.linalg.norm(measured.momentum_change, axis=2)
    return Calibration(
        parameters=parameters,
        evaluation=found.evaluation,
        held_out=held_out,
        scale=float(change.sum(axis=1).mean()),
        identifiability=identify(objective, parameters, grid, seed=seed),
        shots=measured.count,
        imbalance=float(np.abs(measured.imbalance).max()),
        generations=found.generations,
        converged=found.converged,
    )


@dataclasses.dataclass(frozen=True)
class _Search:
    """One search of a calibration, maybe in a process of its own.

    Attributes:
        seed: Of the search.
        tell: Told of every generation; None where it cannot be called.
    """

    seed: int
    tell: Progress | None

    def __call__(self, task: tuple[str, GridEvaluation]) -> Found:
        """Finds the best candidate; the task is what to call it and what to search."""
        what, evaluation = task

        def report(generation: int, value: float) -> None:
            if self.tell is not None:
                self.tell(
                    f"{what}: generation {generation}, evaluation value {value:.3e}"
                )

        return search(evaluation, seed=self.seed, progress=report)


def _searches(
    objectives: Sequence[Objective],
    grid: tuple[Axis, ...],
    seed: int,
    executor: Executor | None,
    tell: Progress,
) -> list[Found]:
    """Returns what is found on all shots, and on those of each fold."""
    folds = len(objectives) - 1
    names = ["search", *(f"held out {fold + 1} of {folds}" for fold in range(folds))]
    evaluations = [GridEvaluation(part, grid) for part in objectives]
    here = executor is None
    results = in_order(
        _Search(seed, tell if here else None),
        list(zip(names, evaluations, strict=True)),
        executor=executor,
        processes=1 if here else None,
    )
    found = []
    for name, one in zip(names, results, strict=True):
        if not here:
            tell(f"{name}: evaluation value {one.evaluation:.3e}")
        found.append(one)
    return found


def _held_out_parts(shots: Shots, folds: int) -> list[tuple[Shots, Shots]]:
    """Returns the shots that are held out, and the rest, for each fold."""
    if folds < 2:
        return []
    number = np.arange(shots.count) % folds
    return [
        (
            shots.subset(np.flatnonzero(number == fold)),
            shots.subset(np.flatnonzero(number != fold)),
        )
        for fold in range(folds)
    ]


def _held_out(
    objective: Objective,
    grid: tuple[Axis, ...],
    parts: Sequence[Shots],
    found: Sequence[Found],
) -> float | None:
    """Returns the evaluation value on shots that took no part in the search."""
    if not parts:
        return None
    names = tuple(axis.name for axis in grid)
    total = 0.0
    for shots, one in zip(parts, found, strict=True):
        held = dataclasses.replace(objective, shots=shots)
        value = float(held(candidates_of(one.values[np.newaxis], names))[0])
        total += value * shots.count
    return total / objective.shots.count


def _parameters(
    values: Array, grid: tuple[Axis, ...], objective: Objective
) -> Parameters:
    """Returns the parameters of the values found."""
    value = {axis.name: float(v) for axis, v in zip(grid, values, strict=True)}
    alpha = tuple(v for name, v in value.items() if name.startswith("alpha"))
    single = {name: v for name, v in value.items() if not name.startswith("alpha")}
    return Parameters(alpha=alpha, w0=objective.w0, kappa=objective.kappa, **single)
