"""The table of friction in docs/benchmarks, from results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from mujoco_impact.text import markdown_table
from mujoco_impact_lab.bench.mujoco_methods import OURS
from mujoco_impact_lab.bench.page import HEADINGS, cells, short_error, with_table
from mujoco_impact_lab.bench.points import Point, front_of
from mujoco_impact_lab.bench.results import Results, read_results
from mujoco_impact_lab.bench.summary import summarize

BEGIN = "<!-- written by scripts/bench from docs/benchmarks/friction/results.json -->"

ERROR = "velocity_error"
"""Field of a point that holds the error, whatever it is one of."""

MORE = (
    "most accurate MuJoCo (run time)",
    "ours on the front",
    "of ours, beaten",
)


def friction_table(results: Results) -> str:
    """Returns the table in Markdown, one line per scene."""
    lines = list[tuple[str, ...]]()
    for row in summarize(results.points):
        points = results.of_scene(row.scene)
        more = (_best_mujoco(points), _on_front(points))
        title = results.scenes[row.scene]
        beaten = f"{len(row.beaten)} of {row.points}"
        lines.append((*cells(row, title), *more, beaten))
    return markdown_table((*HEADINGS, *MORE), lines)


def friction_failures(results: Results) -> str:
    """Returns what was not measured, what failed, and what beats a point of ours."""
    lines = [f"not measured: {name}: {why}" for name, why in results.missing.items()]
    for row in summarize(results.points):
        lines += [f"beaten on {row.scene}: {beaten}" for beaten in row.beaten]
    failed = [point for point in results.points if point.failure]
    lines += [
        f"failed on {point.scene}: {point.method}, {point.timestep * 1e3:g} ms, "
        f"{point.setting}: {point.failure}"
        for point in failed
    ]
    return "\n".join(lines)


def write_page(results: Path, page: Path) -> None:
    """Writes the table of a `results.json`, rounded as it is, into a page."""
    table = friction_table(read_results(results))
    text = with_table(page.read_text(encoding="utf-8"), table, BEGIN)
    page.write_text(text, encoding="utf-8")


def _best_mujoco(points: Sequence[Point]) -> str:
    """Returns error and cost of MuJoCo's most accurate setting, whatever it costs."""
    known = [
        point
        for point in points
        if point.method.startswith("mujoco") and math.isfinite(point.cost)
    ]
    best = min(known, key=lambda point: float(getattr(point, ERROR)), default=None)
    if best is None:
        return "-"
    return f"{short_error(getattr(best, ERROR))} ({best.cost:.2g})"


def _on_front(points: Sequence[Point]) -> str:
    """Returns timesteps and integrators of our points on the front."""
    ours = [point for point in front_of(points, ERROR) if point.method == OURS]
    names = [
        f"{point.timestep * 1e3:g} ms {point.integrator}"
        + ("" if point.setting == "defaults" else f", {point.setting}")
        for point in ours
    ]
    return "; ".join(names) or "none"
