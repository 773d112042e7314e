"""What a run of the benchmark leaves behind: files, and tables on the terminal."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from mujoco_impact.bench.charts import draw_charts
from mujoco_impact.bench.results import Results, write_results
from mujoco_impact.bench.tables import front_table, step_table


def write_files(results: Results, folder: Path) -> tuple[Path, ...]:
    """Writes results and charts; returns the paths written."""
    return (*write_results(results, folder), *draw_charts(results, folder))


def show(results: Results, console: Console) -> None:
    """Prints the front of each scene, the times of single steps, and what failed."""
    for scene in results.scenes:
        console.print(front_table(results, scene))
        console.print()
    if results.steps:
        console.print(step_table(results))
    for reason, names in _by_reason(results.missing).items():
        console.out(f"not measured, {reason}: {', '.join(names)}")
    for point in results.points:
        if point.failure:
            what = f"{point.scene}, {point.method}, {point.setting}"
            console.out(f"{what} ({point.timestep * 1e3:g} ms): {point.failure}")


def _by_reason(missing: dict[str, str]) -> dict[str, list[str]]:
    """Returns what was not measured, by the reason for it."""
    reasons: dict[str, list[str]] = {}
    for name, reason in missing.items():
        reasons.setdefault(reason, []).append(name)
    return reasons
