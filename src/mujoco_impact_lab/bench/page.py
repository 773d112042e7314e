"""The table of docs/validation.md, from the points of a `results.csv`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from mujoco_impact.text import markdown_table
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import ResultsError, points_from_csv
from mujoco_impact_lab.bench.scenes import SCENES
from mujoco_impact_lab.bench.summary import Summary, summarize

BEGIN = "<!-- written by scripts/bench from docs/benchmarks/results.csv -->"
END = "<!-- end of what scripts/bench writes -->"

SHOWN = ("S1", "S2", "S4", "S5", "e09")
"""Scenes of the table."""

ENGINES = {
    "exudyn": "Exudyn",
    "pymunk": "Pymunk",
    "pybullet": "PyBullet",
    "dart": "DART",
}

HEADINGS = (
    "scene",
    "ours",
    "run time",
    "error",
    "MuJoCo's defaults",
    "best MuJoCo at no more run time",
    "most accurate other engine (run time)",
)


def page_table(points: Sequence[Point]) -> str:
    """Returns the table in Markdown, one line per scene that has points of ours."""
    shown = (
        cells(row, SCENES[row.scene].title)
        for row in summarize(points)
        if row.scene in SHOWN and row.error == "velocity_error"
    )
    return markdown_table(HEADINGS, shown)


def with_table(text: str, table: str, begin: str = BEGIN) -> str:
    """Returns a page with the table between its two comments.

    Args:
        text: The page.
        table: The table in Markdown.
        begin: The comment before it; `END` is the one after it.

    Raises:
        ResultsError: If a comment is missing.
    """
    before, found, rest = text.partition(f"{begin}\n")
    _, end, after = rest.partition(END)
    if not found or not end:
        msg = f"the table has no place: {begin!r} and {END!r} must stand in the text"
        raise ResultsError(msg)
    return f"{before}{found}{table}{end}{after}"


def cells(row: Summary, title: str) -> tuple[str, ...]:
    """Returns the cells of a line, as `HEADINGS` names them."""
    engine = "-"
    if math.isfinite(row.engine):
        name = ENGINES.get(row.engine_name, row.engine_name)
        engine = f"{short_error(row.engine)} ({name}, {row.engine_cost:.2g})"
    # "ours, 2 ms, Euler": the heading says the first word
    setting = row.setting.partition(", ")[2]
    return (
        title,
        setting,
        f"{row.cost:.2f}",
        short_error(row.ours),
        short_error(row.default),
        short_error(row.mujoco),
        engine,
    )


def short_error(value: float) -> str:
    """Returns an error to one digit, as in 5e-6 or 0.4."""
    if math.isnan(value):
        return "-"
    if value >= 0.1:
        return f"{value:.1f}"
    mantissa, _, exponent = f"{value:.0e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def write_table(results: Path, page: Path) -> None:
    """Writes the table of a `results.csv` into a page."""
    points = points_from_csv(results.read_text(encoding="utf-8"))
    text = with_table(page.read_text(encoding="utf-8"), page_table(points))
    page.write_text(text, encoding="utf-8")
