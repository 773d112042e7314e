"""The report of a scene that was run in many ways."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mujoco_impact.report import figures
from mujoco_impact.report.page import Page, Section
from mujoco_impact.report.tables import html_table
from mujoco_impact.stress.findings import HEADING, Finding, findings_rows

NEUTRAL = "#7a8b9c"
"""Colour of what is not bad."""


def scene_page(
    findings: Sequence[Finding], *, scene: str, command: str, facts: dict[str, str]
) -> Page:
    """Returns the page of a scene that was run in many ways.

    Args:
        findings: One per way; the scene as it is comes first.
        scene: Its name.
        command: The command that made the page.
        facts: What was run.
    """
    # names and verdicts are words, between them are numbers
    words = [name in ("run", "verdict") for name in HEADING]
    bad = [bool(one.problems) for one in findings]
    notes = (
        f"{len(findings)} ways of running the scene, {sum(bad)} with a problem (red).",
    )
    names = [finding.variation for finding in findings]
    plots = [
        _bars(
            "Deepest overlap [mm]", names, [one.deepest * 1e3 for one in findings], bad
        ),
        _bars(
            "Way of the fastest geom in a step / gap (above 1 an impact may be missed)",
            names,
            [one.farthest for one in findings],
            bad,
        ),
        _bars(
            "Change of energy / largest kinetic energy",
            names,
            [one.energy for one in findings],
            bad,
        ),
    ]
    return Page(
        title=f"Stress report of {scene}",
        command=command,
        facts=facts,
        sections=(
            Section(
                "Findings", html_table(HEADING, findings_rows(findings), left=words)
            ),
            Section("Plots", plot=figures.grid(plots, columns=1)),
        ),
        notes=notes,
    )


def _bars(what: str, names: list[str], values: list[float], bad: list[bool]) -> Any:
    """Returns a plot of one bar for each name; what is bad is red."""
    colours = [figures.COLOURS[0] if one else NEUTRAL for one in bad]
    return figures.bars(what, what, names, values, colours=colours)
