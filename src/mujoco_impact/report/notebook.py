"""What a notebook shows of a run and of a comparison."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

from mujoco_impact.impact_list import listed

if TYPE_CHECKING:
    from mujoco_impact.comparison import Comparison
    from mujoco_impact.trajectory import Trajectory

MOST_ROWS = 12
"""Impacts shown at most."""

_HEADINGS = ("time [s]", "geoms", "closing speed [m/s]", "impulse [N s]", "peak [N]")

_COMPARED = (
    "method",
    "velocity error [v0]",
    "impacts",
    "energy lost in impacts, part of all energy of motion",
    "deepest overlap [m]",
    "run time [ms per s]",
    "failure",
)


def trajectory_html(trajectory: Trajectory) -> str:
    """Returns a run as HTML: its facts, remarks and first impacts."""
    meetings, bounces = listed(
        trajectory.impacts,
        timestep=trajectory.timestep,
        end=float(trajectory.time[-1]),
    )
    rows = [
        (
            f"{one.time:.6f}",
            " - ".join(one.geoms),
            f"{one.closing_speed:.4g}",
            f"{one.impulse:.4g}",
            f"{one.peak:.4g}",
        )
        for one in meetings[:MOST_ROWS]
    ]
    lines = [str(one) for one in bounces[:MOST_ROWS]]
    hidden = len(meetings) - len(rows)
    if hidden > 0:
        lines.insert(0, f"and {hidden} more")
    lines += [remark.text for remark in trajectory.remarks]
    table = table_html(_HEADINGS, rows) if rows else ""
    return f"<p>{escape(repr(trajectory)[1:-1])}</p>{table}{_paragraphs(lines)}"


def comparison_html(comparison: Comparison) -> str:
    """Returns a comparison as HTML: its table, headline and note."""
    rows = [
        (
            row["method"],
            _number(row["velocity_error"]),
            _number(row["impacts"]),
            _number(row["energy_lost"]),
            _number(row["deepest_overlap"]),
            _number(row["run_time"], 1e3),
            row["failure"],
        )
        for row in comparison.table()
    ]
    kept = [
        number for number in range(len(_COMPARED)) if any(row[number] for row in rows)
    ]
    table = table_html(
        [_COMPARED[number] for number in kept],
        [[row[number] for number in kept] for row in rows],
    )
    lines = [line for line in (comparison.headline(), comparison.note) if line]
    return f"<p>{escape(repr(comparison)[1:-1])}</p>{table}{_paragraphs(lines)}"


def _number(value: float | None, scale: float = 1.0) -> str:
    """Returns a number in three digits, "" for None."""
    return "" if value is None else f"{scale * value:.3g}"


def table_html(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns a table of text."""
    head = "".join(f"<th>{escape(one)}</th>" for one in headings)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _paragraphs(lines: Iterable[str]) -> str:
    """Returns lines of text."""
    return "".join(f"<p>{escape(line)}</p>" for line in lines)
