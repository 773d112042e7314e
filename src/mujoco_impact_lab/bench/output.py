"""What a run of the benchmark leaves behind: files, and tables on the terminal."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from mujoco_impact_lab.bench.charts import draw_charts
from mujoco_impact_lab.bench.overview import draw_overview
from mujoco_impact_lab.bench.results import Results, write_results
from mujoco_impact_lab.bench.summary import summarize
from mujoco_impact_lab.bench.tables import (
    ERROR_WORDS,
    front_table,
    impact_table,
    step_table,
    summary_table,
    wave_table,
)


def write_files(results: Results, folder: Path) -> tuple[Path, ...]:
    """Writes results and charts; returns the paths written."""
    # first: it makes the folder
    files = write_results(results, folder)
    return (*files, *draw_charts(results, folder), *draw_overview(results, folder))


def show(results: Results, console: Console) -> None:
    """Prints fronts, times of single steps and impacts, a summary, and what failed."""
    for scene in results.scenes:
        console.print(front_table(results, scene))
        console.print()
    _show_times(results, console)
    _show_summary(results, console)
    for reason, names in _by_reason(results.missing).items():
        console.out(f"not measured, {reason}: {', '.join(names)}")
    for point in results.points:
        if point.failure:
            what = f"{point.scene}, {point.method}, {point.setting}"
            console.out(f"{what} ({point.timestep * 1e3:g} ms): {point.failure}")


def _show_times(results: Results, console: Console) -> None:
    """Prints what single steps and impacts cost, as far as they were timed."""
    for rows, table in (
        (results.steps, step_table),
        (results.impacts, impact_table),
        (results.waves, wave_table),
    ):
        if rows:
            console.print(table(results))
            console.print()


def _show_summary(results: Results, console: Console) -> None:
    """Prints the summary, and what beats a point of ours."""
    if not results.points:
        return
    console.print(summary_table(results))
    for row in summarize(results.points):
        for beaten in row.beaten:
            console.out(f"beaten on {row.scene}, {ERROR_WORDS[row.error]}: {beaten}")


def _by_reason(missing: dict[str, str]) -> dict[str, list[str]]:
    """Returns what was not measured, by the reason for it."""
    reasons: dict[str, list[str]] = {}
    for name, reason in missing.items():
        reasons.setdefault(reason, []).append(name)
    return reasons
