"""Tables of the benchmark for the terminal (needs rich)."""

from __future__ import annotations

import math

from rich.table import Table

from mujoco_impact.bench.mujoco_methods import OURS
from mujoco_impact.bench.points import Point, front_of
from mujoco_impact.bench.results import Results
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
        table.add_row(point.method, _setting(point), *cells, style=style)
    return table


def step_table(results: Results) -> Table:
    """Returns the times of single steps."""
    table = Table(title="single steps at 2 ms [us]", box=None)
    table.add_column("case", no_wrap=True)
    for heading in ("mean", "p50", "p99", "worst", "floor\nmean", "mean /\nfloor"):
        table.add_column(heading, justify="right")
    for row in results.steps:
        times = (row.mean, row.p50, row.p99, row.worst, row.floor, row.ratio)
        table.add_row(row.case, *[f"{value:.2f}" for value in times])
    return table


def _setting(point: Point) -> str:
    """Returns timestep, integrator and setting in a few words."""
    parts = [] if math.isnan(point.timestep) else [f"{point.timestep * 1e3:g} ms"]
    parts.append(point.integrator)
    if point.setting != "defaults":
        parts.append(point.setting)
    return ", ".join(parts)


def _number(value: float) -> str:
    """Returns a number in three digits, or a dash."""
    return NOTHING if math.isnan(value) else f"{value:.3g}"
