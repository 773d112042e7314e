"""Tables for the terminal (needs rich).

Print them on a console without markup: headings hold units in brackets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from mujoco_impact.calibration import Calibration, Identifiability
from mujoco_impact.comparison import OURS, Comparison
from mujoco_impact.doctor import Check
from mujoco_impact.impact_list import Meeting
from mujoco_impact.trajectory import Array, Trajectory

MOST_BALLS_ABREAST = 6
"""More balls than this stand below each other, to fit 80 columns."""

MOST_BODIES = 12
"""Bodies of the first impact that the table shows; the others are counted."""

MOST_ABREAST = 3
"""More bodies than this stand below each other."""

ROUNDING = 1e-9
"""Errors below it are told as being below it."""

NOTHING = "-"
"""What stands where there is no number."""


def comparison_table(comparison: Comparison) -> Table:
    """Returns what each method came to, one row each; no column is empty."""
    title = f"{comparison.scene} from {comparison.start}, {comparison.duration:g} s"
    rows = comparison.table()
    columns = {
        heading: [cell(row) for row in rows]
        for heading, cell in _CELLS.items()
        if any(cell(row) != NOTHING for row in rows)
    }
    lines = [
        [row["method"], *([column[number] for column in columns.values()])]
        if not row["failure"]
        else [row["method"], "failed", *[NOTHING] * (len(columns) - 1)]
        for number, row in enumerate(rows)
    ]
    table = Table(title=title, box=None, padding=(0, 1, 0, 0), pad_edge=False)
    _fill(table, ["method", *columns], lines)
    return table


def speed_table(comparison: Comparison) -> Table:
    """Returns velocities before and after the first impact, per method and body.

    Up to `MOST_ABREAST` bodies stand beside each other; more stand below each other,
    with the velocities before it of our motion.
    """
    bodies = comparison.bodies[:MOST_BODIES]
    line = comparison.line()
    known, ours = comparison.impact_reference, comparison.method(OURS)
    motions = [(one.name, one.before, one.after) for one in comparison.methods]
    if known is not None and ours.trajectory is not None:
        after = known.at(float(ours.trajectory.time[comparison.first.after]))
        motions.insert(0, (known.name, ours.before, after))
    what = "speeds" if line is None else "velocities"
    where = "" if line is None else ", along its line"
    title = f"{what} before and after the first impact{where} [m/s]"
    table = Table(title=title, box=None)
    if len(bodies) <= MOST_ABREAST:
        lines = [
            [name, *_before_after(before, after, len(bodies), line)]
            for name, before, after in motions
        ]
        _fill(table, ["method", *bodies], lines)
        return table
    columns = [_speeds(ours.before, len(bodies), line)]
    columns += [_speeds(after, len(bodies), line) for _, _, after in motions]
    rows = [[body, *cells] for body, *cells in zip(bodies, *columns, strict=True)]
    headings = ["", "before", *(name for name, _, _ in motions)]
    _fill(table, [*map(_narrow, headings)], rows)
    return table


def _before_after(
    before: Array | None, after: Array | None, count: int, line: Array | None
) -> list[str]:
    """Returns the cells of one method."""
    if before is None or after is None:
        return [NOTHING] * count
    pairs = zip(_speeds(before, count, line), _speeds(after, count, line), strict=True)
    return [f"{one} → {other}" for one, other in pairs]


def _speeds(velocities: Array | None, count: int, line: Array | None) -> list[str]:
    """Returns the first velocities as text: along a line, or their size."""
    if velocities is None:
        return [NOTHING] * count
    along = np.linalg.norm(velocities, axis=1) if line is None else velocities @ line
    return [_speed(float(value)) for value in along[:count]]


def _speed(value: float) -> str:
    """Returns a speed with three decimals, less if it is large, no negative zero."""
    decimals = max(0, 3 - max(0, len(str(int(abs(value)))) - 1))
    return f"{value if abs(value) >= 5e-4 else 0.0:.{decimals}f}"


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
        table.add_column(heading, justify="left" if left else "right", no_wrap=True)
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
    """Returns an error in two digits, or a dash; rounding is no error."""
    if value is None:
        return NOTHING
    return f"{value:.1e}" if value >= ROUNDING else f"<{ROUNDING:.0e}"


def _part(value: float | None) -> str:
    """Returns a part as percent, or a dash."""
    if value is None:
        return NOTHING
    if abs(value) < 1e-5:
        return "0 %"
    percent = 100 * value
    if abs(percent) >= 10:
        return f"{percent:.0f} %"
    return f"{percent:.1f} %" if abs(percent) >= 0.1 else f"{percent:.1g} %"


def _length(value: float | None) -> str:
    """Returns a length in mm or µm, or a dash."""
    if value is None:
        return NOTHING
    if value < 1e-9:
        return "none"
    return f"{value * 1e6:.2g} µm" if value < 1e-4 else f"{value * 1e3:.2g} mm"


_CELLS: dict[str, Callable[[dict[str, Any]], str]] = {
    "error\n[v0]": lambda row: number(row["velocity_error"]),
    "angle\n[rad]": lambda row: number(row["angle_rms"]),
    "impacts": lambda row: NOTHING if row["impacts"] is None else str(row["impacts"]),
    "energy\nlost": lambda row: _part(row["energy_lost"]),
    "deepest\noverlap": lambda row: _length(row["deepest_overlap"]),
    "passed\nthrough": lambda row: str(len(row["passed"]) or NOTHING),
    "run time\n[ms/s]": lambda row: (
        NOTHING if row["run_time"] is None else f"{row['run_time'] * 1e3:.2f}"
    ),
    "ratio": lambda row: (
        NOTHING
        if row["cost"] is None
        else f"{row['cost']:.{2 if row['cost'] < 100 else 0}f}"
    ),
}
"""Columns of the table of a comparison, and what stands in them."""


def _signed(values: Iterable[float]) -> list[str]:
    """Returns velocities with four decimals and no negative zeros."""
    return [f"{value + 0.0 if abs(value) > 5e-5 else 0.0:.4f}" for value in values]


def parameter_table(found: Calibration) -> Table:
    """Returns the parameters, with the values that would fit as well."""
    table = Table(title="parameters", box=None)
    table.add_column("name")
    table.add_column("value", justify="right")
    if found.identifiability is None:
        for name, value in found.settings.items():
            table.add_row(name, str(value))
        return table
    table.add_column("as good", justify="right")
    table.add_column("")
    for one in found.identifiability.ranges:
        table.add_row(
            one.name, f"{one.value:.6g}", f"{one.low:.4g} to {one.high:.4g}", one.note
        )
    return table


def combination_table(found: Identifiability) -> Table:
    """Returns what the shots determine, with its intervals."""
    table = Table(title="what the shots determine", box=None)
    table.add_column("combination")
    for heading in ("value", "interval of 95 %", "unit"):
        table.add_column(heading, justify="right" if heading != "unit" else "left")
    for one in found.combinations:
        table.add_row(
            one.name, f"{one.value:.5g}", f"{one.low:.5g} to {one.high:.5g}", one.unit
        )
    return table
