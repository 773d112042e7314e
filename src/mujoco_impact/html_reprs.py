"""What a notebook shows of a run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

from mujoco_impact.impact_list import listed

if TYPE_CHECKING:
    from mujoco_impact.trajectory import Trajectory

MOST_ROWS = 12
"""Impacts shown at most."""

_HEADINGS = ("time [s]", "geoms", "closing speed [m/s]", "impulse [N s]", "peak [N]")


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
