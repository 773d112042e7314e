"""Tables of the benchmark for the terminal (needs rich)."""

from __future__ import annotations

import math
from collections.abc import Iterable

from rich.table import Table

from mujoco_impact.bench.mujoco_methods import OURS
from mujoco_impact.bench.points import front_of, setting_of
from mujoco_impact.bench.results import Results
from mujoco_impact.bench.summary import Summary, summarize
from mujoco_impact.tables import NOTHING

NUMBERS = ("cost", "velocity_error", "angle_rms", "energy_drift")


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
    table = _table("single steps at 2 ms [us]", "case", (
        "mean", "p50", "p99", "worst", "floor\nmean", "mean /\nfloor",
        "mean /\nball", "floor /\nball",
    ))  # fmt: skip
    for row in results.steps:
        times = (row.mean, row.p50, row.p99, row.worst, row.floor, row.ratio,
                 row.per_ball, row.floor_per_ball)  # fmt: skip
        table.add_row(row.case, *[f"{value:.2f}" for value in times])
    return table


def impact_table(results: Results) -> Table:
    """Returns what one impact costs, by the law and by the loop."""
    table = _table("one impact of a row, the law alone and a loop", "balls", (
        "tolerance", "steps", "error\n[v0]", "median\n[us]", "fastest\n[us]",
        "loop\nsteps", "loop error\n[v0]", "loop\n[us]", "law /\nloop",
    ))  # fmt: skip
    for row in results.impacts:
        law = (row.tolerance, row.steps, row.error, row.microseconds, row.fastest)
        loop = (row.loop_steps, row.loop_error, row.loop_microseconds, row.ratio)
        table.add_row(str(row.balls), *map(_number, (*law, *loop)))
    return table


def wave_table(results: Results) -> Table:
    """Returns what an impact that travels through a long row costs."""
    headings = ("steps", "[us]", "[us] /\nball", "relative")
    table = _table("an impact through a long row, the law alone", "balls", headings)
    for row in results.waves:
        numbers = (row.microseconds, row.per_ball, row.relative)
        table.add_row(str(row.balls), str(row.steps), *map(_number, numbers))
    return table


def summary_table(results: Results) -> Table:
    """Returns every scene at the run time of MuJoCo's defaults."""
    table = _table("at the run time of MuJoCo's defaults", "scene", (
        "error", "run time\nratio", "ours", "best\nMuJoCo", "MuJoCo /\nours",
        "our points\nbeaten", "on our\nfront",
    ))  # fmt: skip
    for row in summarize(results.points):
        numbers = map(_number, (row.cost, row.ours, row.mujoco, row.advantage))
        table.add_row(row.scene, row.error, *numbers, *_beaten(row))
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
