"""Reports of a stress run: of a scene of one's own, and of random scenes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mujoco_impact.report import figures
from mujoco_impact.report.page import Page, Section
from mujoco_impact.report.tables import of_markdown
from mujoco_impact.stress import OURS, Family, Finding, Summary, markdown

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
            Section("Findings", of_markdown(markdown.findings_table(findings))),
            Section("Plots", plot=figures.grid(plots, columns=1)),
        ),
        notes=notes,
    )


def sweep_page(summary: Summary, family: Family, text: str, *, command: str) -> Page:
    """Returns the page of random scenes.

    Args:
        summary: The sweep.
        family: The kind of the scenes.
        text: The section of the report in markdown.
        command: The command that made the page.
    """
    names, values = [], []
    for method in summary.methods:
        broken = sum(
            tally.violations + sum(tally.beyond.values())
            for tally in summary.tallies
            if tally.method == method
        )
        names.append(method)
        values.append(float(broken))
    return Page(
        title=f"Stress report: {summary.cases} random {family.name}",
        command=command,
        facts={
            "scenes": str(summary.cases),
            "impacts": str(summary.impacts),
            "violations of ours": str(summary.violations(OURS)),
        },
        sections=(
            Section(
                "Broken promises, those outside of the documented limits included",
                plot=_bars(
                    "promises broken", names, values, [n == OURS for n in names]
                ),
            ),
            Section("Numbers", of_markdown(text)),
        ),
    )


def _bars(what: str, names: list[str], values: list[float], bad: list[bool]) -> Any:
    """Returns a plot of one bar for each name; what is bad is red."""
    colours = [figures.COLOURS[0] if one else NEUTRAL for one in bad]
    return figures.bars(what, what, names, values, colours=colours)
