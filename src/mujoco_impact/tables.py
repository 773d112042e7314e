"""Tables for the terminal (needs rich).

Print them on a console without markup: headings hold units in brackets.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.table import Table
from rich.text import Text

from mujoco_impact.comparison import OURS, Comparison
from mujoco_impact.doctor import Check
from mujoco_impact.impact_list import Meeting
from mujoco_impact.trajectory import Trajectory

MOST_BALLS_ABREAST = 6
"""More balls than this stand below each other, to fit 80 columns."""

NOTHING = "-"
"""What stands where there is no number."""


def comparison_table(comparison: Comparison) -> Table:
    """Returns errors and run times, one row per method."""
    table = Table(title=f"{comparison.scene}, {comparison.duration:g} s", box=None)
    for heading in (
        "method",
        "velocity\nerror [v0]",
        "angle RMS\n[rad]",
        "energy\ndrift",
        "run time\n[ms per s]",
        "run time\nratio",
    ):
        left = heading == "method"
        table.add_column(heading, justify="left" if left else "right", no_wrap=left)
    for row in comparison.table():
        if row["failure"]:
            table.add_row(row["method"], "failed", *[NOTHING] * 4)
            continue
        run_time = row["run_time"]
        table.add_row(
            row["method"],
            number(row["velocity_error"]),
            number(row["angle_rms"]),
            number(row["energy_drift"]),
            NOTHING if run_time is None else f"{run_time * 1e3:.2f}",
            NOTHING if row["cost"] is None else f"{row['cost']:.2f}",
            style="bold" if row["method"] == OURS else None,
        )
    return table


def velocity_table(comparison: Comparison) -> Table:
    """Returns the velocities that the first impact leaves, per method and ball."""
    truth = comparison.reference_velocities or ()
    balls = [f"ball {number}" for number in range(1, len(truth) + 1)]
    lines = [["Hertz reference", *_signed(truth)]]
    for method in comparison.methods:
        left = method.first_velocities
        cells = [NOTHING] * len(truth) if left is None else _signed(left)
        lines.append([method.name, *cells])
    table = Table(title="velocities after the first impact / impact speed", box=None)
    if len(balls) <= MOST_BALLS_ABREAST:
        _fill(table, ["method", *balls], lines)
        return table
    headings, *columns = zip(*lines, strict=True)
    rows = [[ball, *cells] for ball, cells in zip(balls, columns, strict=True)]
    _fill(table, ["", *map(_narrow, headings)], rows)
    return table


def _fill(table: Table, headings: Sequence[str], lines: Sequence[list[str]]) -> None:
    """Adds a column of names, columns of numbers, and the rows; ours is bold."""
    for position, heading in enumerate(headings):
        left = position == 0
        table.add_column(heading, justify="left" if left else "right", no_wrap=left)
    for line in lines:
        table.add_row(*line, style="bold" if line[0] == OURS else None)


def _narrow(heading: str) -> str:
    """Breaks a heading wherever it can be broken."""
    return heading.replace(" ", "\n").replace("-", "-\n")


def impact_table(meetings: Sequence[Meeting], *, limit: int) -> Table:
    """Returns the first impacts, one row each."""
    shown = meetings[:limit]
    several = any(one.points > 1 for one in shown)
    table = Table(title=f"impacts: {len(meetings)}", box=None)
    table.add_column("time\n[s]", justify="right")
    table.add_column("geoms", no_wrap=True)
    for heading in ("closing\n[m/s]", "impulse\n[N s]", "peak\n[N]", "lasts\n[ms]"):
        table.add_column(heading, justify="right")
    if several:
        table.add_column("points", justify="right")
    for one in shown:
        table.add_row(
            f"{one.time:.6f}",
            " - ".join(one.geoms),
            f"{max(one.closing_speed, 0.0):.4g}",
            f"{one.impulse:.5g}",
            f"{one.peak:.4g}",
            f"{one.duration * 1e3:.4g}",
            *([str(one.points)] if several else []),
        )
    return table


def check_table(checks: Iterable[Check]) -> Table:
    """Returns the outcome of the checks of an installation."""
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for check in checks:
        mark = Text("ok", "green") if check.passed else Text("FAILED", "red")
        table.add_row(mark, check.name, check.found)
        if check.remedy:
            table.add_row("", "remedy", check.remedy)
    return table


def energy_line(trajectory: Trajectory) -> str:
    """Returns the energies at the start and at the end of a run in words."""
    total = trajectory.total_energy
    return f"energy {total[0]:.6g} J at the start, {total[-1]:.6g} J at the end"


def number(value: float | None) -> str:
    """Returns a number in three digits, or a dash."""
    return NOTHING if value is None else f"{value:.2e}"


def _signed(values: Iterable[float]) -> list[str]:
    """Returns velocities with four decimals and no negative zeros."""
    return [f"{value + 0.0 if abs(value) > 5e-5 else 0.0:.4f}" for value in values]
