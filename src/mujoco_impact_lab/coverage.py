"""How often the intervals of a calibration hold the truth: many seeds, many rows."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cradle_models
from mujoco_impact.calibration.fit import calibrate
from mujoco_impact.calibration.objective import DEFAULT_W0
from mujoco_impact.calibration.synthetic import hertz_truth, synthetic_shots
from mujoco_impact.executors import in_order

VELOCITY_NOISE = 0.01
SEEDS = 50


@dataclass(frozen=True)
class Coverage:
    """How a combination of one pattern was found over many seeds.

    Attributes:
        pattern: The row of balls.
        combination: Name of the combination.
        truth: What generated the shots.
        held: Part of the seeds whose interval holds the truth.
        bias: Mean of value - truth, relative to the truth.
        spread: Standard deviation of the value, relative.
        width: Mean half-width of the interval, relative.
    """

    pattern: str
    combination: str
    truth: float
    held: float
    bias: float
    spread: float
    width: float


@dataclass(frozen=True)
class _Calibrated:
    """Value, low and high of each combination by one calibration, and its time [s]."""

    pattern: str
    intervals: dict[str, tuple[float, float, float]]
    seconds: float


@dataclass(frozen=True)
class _Shots:
    """Shots to make, and to calibrate on."""

    pattern: str
    count: int
    velocity_noise: float
    seed: int


def coverage(
    patterns: Sequence[str],
    *,
    seeds: Sequence[int] = range(SEEDS),
    velocity_noise: float = VELOCITY_NOISE,
    count: int = 10,
    executor: Executor | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[list[Coverage], float]:
    """Calibrates on synthetic shots of patterns, once per seed.

    Args:
        patterns: Letters A and B.
        seeds: Seeds of the errors of the shots.
        velocity_noise: Error of every velocity component, over the impact speed.
        count: Shots of one calibration.
        executor: Where to calibrate, see `in_order`.
        progress: Told what is going on.

    Returns:
        The rows, and the time of one calibration [s].
    """
    tasks = [
        _Shots(pattern, count, velocity_noise, seed)
        for pattern in patterns
        for seed in seeds
    ]
    found = list[_Calibrated]()
    for task, one in zip(
        tasks, in_order(_calibrated, tasks, executor=executor), strict=True
    ):
        found.append(one)
        if progress is not None:
            progress(f"{task.pattern}, seed {task.seed}")
    rows = [row for pattern in patterns for row in _of_pattern(pattern, found)]
    return rows, float(np.mean([one.seconds for one in found]))


def _calibrated(task: _Shots) -> _Calibrated:
    """Makes shots and calibrates on them, maybe in a process of its own."""
    begin = time.perf_counter()
    shots = synthetic_shots(
        cradle_models.balls(task.pattern),
        count=task.count,
        velocity_noise=task.velocity_noise,
        seed=task.seed,
    )
    found = calibrate(shots, folds=0, seed=task.seed).identifiability
    intervals = {
        each.name: (each.value, each.low, each.high)
        for each in (found.combinations if found is not None else ())
    }
    return _Calibrated(task.pattern, intervals, time.perf_counter() - begin)


def _of_pattern(pattern: str, found: Sequence[_Calibrated]) -> list[Coverage]:
    """Returns the rows of a pattern."""
    share = hertz_truth(cradle_models.balls(pattern)).share
    # P_k = p share_k = (2/π) α_k S_h W₀ p
    a = share * np.pi / 2 / DEFAULT_W0
    truths = {"alpha_1 S_h": a[0], "alpha_2/alpha_1": a[1] / a[0]}
    return [
        _coverage(
            pattern,
            name,
            float(truth),
            [
                one.intervals[name]
                for one in found
                if one.pattern == pattern and name in one.intervals
            ],
        )
        for name, truth in truths.items()
    ]


def _coverage(
    pattern: str, name: str, truth: float, rows: list[tuple[float, float, float]]
) -> Coverage:
    """Returns the statistics of one combination."""
    value, low, high = np.array(rows).T
    return Coverage(
        pattern=pattern,
        combination=name,
        truth=truth,
        held=float(((low <= truth) & (truth <= high)).mean()),
        bias=float(value.mean() / truth - 1),
        spread=float(value.std(ddof=1) / truth) if len(rows) > 1 else 0.0,
        width=float((high - low).mean() / 2 / truth),
    )


def markdown(rows: Sequence[Coverage], *, seeds: int, seconds: float) -> str:
    """Returns the page of the documentation."""
    lines = [
        "# How often the intervals of a calibration hold the truth",
        "",
        f"{seeds} seeds per pattern; 10 synthetic shots each (Hertz truth, 0.3 to "
        f"0.7 m/s), every velocity component off by {VELOCITY_NOISE:.0%} of the impact "
        "speed; search on the grid of table 1; stated confidence 95 %.",
        "Bias, spread and half-width are in per cent of the truth. Written by",
        "`scripts/bench-calibration`.",
        "",
        "| pattern | combination | truth | held | bias | spread | half-width |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.pattern} | {row.combination} | {row.truth:.4f} | {row.held:.0%} | "
        f"{100 * row.bias:+.2f} | {100 * row.spread:.2f} | {100 * row.width:.2f} |"
        for row in rows
    ]
    means = [
        f"{name} {np.mean([row.held for row in rows if row.combination == name]):.1%}"
        for name in dict.fromkeys(row.combination for row in rows)
    ]
    lines += [
        "",
        f"Over all patterns: {', '.join(means)}. One calibration, search and",
        f"intervals, took {seconds:.1f} s in one process.",
    ]
    return "\n".join(lines) + "\n"


def write_page(target: Path) -> None:
    """Measures the coverage of all patterns and writes the page."""

    def report(text: str) -> None:
        if text.endswith(f"seed {SEEDS - 1}"):
            sys.stderr.write(f"{text}\n")

    rows, seconds = coverage(cradle_models.PAPER_PATTERNS, progress=report)
    target.write_text(markdown(rows, seeds=SEEDS, seconds=seconds), encoding="utf-8")
