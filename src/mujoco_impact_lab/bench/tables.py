"""Tables of the benchmark for the terminal (needs rich)."""

from __future__ import annotations

import math
from collections.abc import Iterable

from rich.table import Table

from mujoco_impact.cli.tables import NOTHING
from mujoco_impact_lab.bench.mujoco_methods import OURS
from mujoco_impact_lab.bench.points import front_of, setting_of
from mujoco_impact_lab.bench.results import Results
from mujoco_impact_lab.bench.summary import Summary, summarize

NUMBERS = ("cost", "velocity_error", "angle_rms", "energy_drift")

ERROR_WORDS = {"velocity_error": "velocity", "angle_rms": "angle"}


def front_table(results: Results, scene: str) -> Table:
    """Returns the points on the front of run time and velocity error of a scene."""
    table = Table(title=f"{scene}: {results.scenes[scene]}, Pareto front", box=None)
    table.add_column("method", no_wrap=True)
    table.add_column("setting", overflow="fold")
    for heading in (
        "run time\nratio",
        "velocity\nerror [v0]",
        "angle RMS\n[rad]",
        "energy\ndrift",
    ):
        table.add_column(heading, justify="right")
    for point in front_of(results.of_scene(scene), "velocity_error"):
        cells = [_number(getattr(point, name)) for name in NUMBERS]
        style = "bold" if point.method == OURS else None
        table.add_row(point.method, setting_of(point), *cells, style=style)
    return table


def step_table(results: Results) -> Table:
    """Returns the times of single steps."""
    headings = ("mean", "p50", "p99", "worst", "floor", "mean /\nfloor", "mean /\nball")
    table = _table("single steps at 2 ms [us]", "case", headings)
    for row in results.steps:
        times = map(_time, (row.mean, row.p50, row.p99, row.worst, row.floor))
        table.add_row(row.case, *times, f"{row.ratio:.3f}", f"{row.per_ball:.3f}")
    return table


def impact_table(results: Results) -> Table:
    """Returns what one impact costs, by the law and by the loop."""
    table = _table("one impact of a row: the law alone, and a loop", "balls", (
        "tolerance", "steps", "error\n[v0]", "median\n[us]", "fastest\n[us]",
        "loop\nerror", "loop\n[us]", "law /\nloop",
    ))  # fmt: skip
    for row in results.impacts:
        numbers = (row.microseconds, row.fastest)
        loop = (f"{row.loop_error:.1e}", _time(row.loop_microseconds))
        table.add_row(
            str(row.balls), f"{row.tolerance:g}", str(row.steps), f"{row.error:.1e}",
            *map(_time, numbers), *loop, f"{row.ratio:.2f}",
        )  # fmt: skip
    return table


def wave_table(results: Results) -> Table:
    """Returns what an impact that travels through a long row costs."""
    headings = ("steps", "[us]", "[us] / ball", "relative")
    table = _table("the law alone: an impact through long rows", "balls", headings)
    for row in results.waves:
        times = f"{row.microseconds:.0f}", f"{row.per_ball:.2f}", f"{row.relative:.3f}"
        table.add_row(str(row.balls), str(row.steps), *times)
    return table


def summary_table(results: Results) -> Table:
    """Returns every scene at the run time of MuJoCo's defaults."""
    table = _table("at the run time of MuJoCo's defaults", "scene", (
        "error", "run time\nratio", "ours", "best\nMuJoCo", "MuJoCo /\nours",
        "our points\nbeaten", "on our\nfront",
    ))  # fmt: skip
    for row in summarize(results.points):
        numbers = map(_number, (row.cost, row.ours, row.mujoco, row.advantage))
        table.add_row(row.scene, ERROR_WORDS[row.error], *numbers, *_beaten(row))
    return table


def _beaten(row: Summary) -> tuple[str, str]:
    """Returns how many of our points something beats, in all and on our front."""
    return f"{len(row.beaten)} of {row.points}", str(row.front_beaten)


def _table(title: str, first: str, headings: Iterable[str]) -> Table:
    """Returns a table of numbers without rows."""
    table = Table(title=title, box=None)
    table.add_column(first, no_wrap=True)
    for heading in headings:
        table.add_column(heading, justify="right")
    return table


def _number(value: float) -> str:
    """Returns a number in three digits, or a dash."""
    return NOTHING if math.isnan(value) else f"{value:.3g}"


def _time(value: float) -> str:
    """Returns a time in three digits, in full."""
    return f"{value:.{max(0, min(2, 2 - math.floor(math.log10(value))))}f}"
