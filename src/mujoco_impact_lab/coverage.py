"""How often the intervals of a calibration hold the truth: many seeds, many rows."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cradle_models
from mujoco_impact.calibration.fit import calibrate
from mujoco_impact.calibration.objective import DEFAULT_W0
from mujoco_impact.calibration.synthetic import hertz_truth, synthetic_shots

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


def coverage(
    pattern: str,
    *,
    seeds: Sequence[int] = range(SEEDS),
    velocity_noise: float = VELOCITY_NOISE,
    count: int = 10,
    progress: Callable[[str], None] | None = None,
) -> tuple[Coverage, ...]:
    """Calibrates on synthetic shots of a pattern, once per seed.

    Args:
        pattern: Letters A and B.
        seeds: Seeds of the errors of the shots.
        velocity_noise: Error of every velocity component, over the impact speed.
        count: Shots of one calibration.
        progress: Told what is going on.
    """
    balls = cradle_models.balls(pattern)
    share = hertz_truth(balls).share
    # P_k = p share_k = (2/π) α_k S_h W₀ p
    a = share * np.pi / 2 / DEFAULT_W0
    truths = {"alpha_1 S_h": a[0], "alpha_2/alpha_1": a[1] / a[0]}
    rows: dict[str, list[tuple[float, float, float]]] = {name: [] for name in truths}
    for seed in seeds:
        shots = synthetic_shots(
            balls, count=count, velocity_noise=velocity_noise, seed=seed
        )
        found = calibrate(shots, folds=0, seed=seed).identifiability
        if found is None:
            continue
        for interval in found.combinations:
            if interval.name in rows:
                row = (interval.value, interval.low, interval.high)
                rows[interval.name].append(row)
        if progress is not None:
            progress(f"{pattern}, seed {seed}")
    return tuple(
        _coverage(pattern, name, float(truths[name]), rows[name]) for name in truths
    )


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
    each = seconds / (seeds * len(rows) / len(means))
    lines += [
        "",
        f"Over all patterns: {', '.join(means)}. One calibration, search and",
        f"intervals, took {each:.1f} s in one process.",
    ]
    return "\n".join(lines) + "\n"


def write_page(target: Path) -> None:
    """Measures the coverage of all patterns and writes the page."""
    begin = time.perf_counter()
    rows: list[Coverage] = []
    for pattern in cradle_models.PAPER_PATTERNS:
        rows += coverage(pattern)
        sys.stderr.write(f"{pattern}: {time.perf_counter() - begin:.0f} s\n")
    seconds = time.perf_counter() - begin
    target.write_text(markdown(rows, seeds=SEEDS, seconds=seconds), encoding="utf-8")
