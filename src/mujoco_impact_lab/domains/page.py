"""The page of the domains: tables of falls and tours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import mujoco
import numpy as np

from mujoco_impact.text import markdown_table
from mujoco_impact_lab.domains.falls import (
    LYING,
    MOVING,
    ROBOTS,
    SECONDS,
    Fall,
    falls,
)
from mujoco_impact_lab.domains.scenes import scenes_of_gymnasium, scenes_of_suite
from mujoco_impact_lab.domains.tours import ACTIONS, Tour, tour

RESTITUTIONS = (1.0, 0.5)
"""Of the contacts of robots: the default, and one of a foot."""

SEEDS = 5
"""Runs of each robot."""

Falls = tuple[list[Fall], list[Fall]]
"""Runs of a robot with our contacts, and with MuJoCo's."""


def write_page(
    target: Path,
    *,
    seeds: int = SEEDS,
    actions: int = ACTIONS,
    report: Callable[[str], None] = lambda _: None,
) -> None:
    """Runs everything and writes the page.

    Args:
        target: The page.
        seeds: Runs of each robot.
        actions: Random actions in each environment.
        report: Is told what is done.
    """
    robots: dict[tuple[str, float], Falls] = {}
    for scene in ROBOTS:
        for restitution in RESTITUTIONS:
            found = falls(scene, restitution=restitution, seeds=seeds)
            robots[scene.name, restitution] = found
            report(f"{scene.name}, restitution {restitution:g}")
    tours = []
    for scene in (*scenes_of_suite(), *scenes_of_gymnasium()):
        tours.append(tour(scene, actions=actions))
        report(scene.name)
    target.write_text(markdown(robots, tours, seeds, actions), encoding="utf-8")


def markdown(
    robots: dict[tuple[str, float], Falls],
    tours: Sequence[Tour],
    seeds: int,
    actions: int,
) -> str:
    """Returns the page."""
    refused = [one for one in tours if one.ours is None]
    played = [one for one in tours if one.ours is not None]
    return f"""# Whole domains

Written by `scripts/domains`; do not edit. Domains of dm_control and gymnasium with the
contacts of all their geoms ours, beside the same domains as they are.

## Robots that move and lie down

{SECONDS:g} s: random actions for {MOVING * SECONDS:g} s, and motors that do nothing
after that; {seeds} runs each. MuJoCo {mujoco.__version__}.
A cell with two numbers has ours / MuJoCo's.

{_motions(robots)}
* *deepest*: largest overlap of two geoms in all runs [mm]; *mean*: of the runs.
* *fastest*: largest velocity of a degree of freedom [m/s, rad/s]; *end*: at the end.
* *lying*: contacts with an impact, per second of the last {LYING * SECONDS:g} s, most
  of all runs. With restitution 1 what lies there still bounces.
* *adds energy*: the most that the impacts of one step have added [J], by the impulses
  of the records and bodies that are followed from impact to impact; and over the
  largest kinetic energy.

What a step costs, over a step with MuJoCo's contacts from the same state. The least of
several turns counts; processor time of one thread.

{_costs(robots)}
* *mean*: all steps of a run, the mean of the runs.
* *worst*: the longest step of all runs, over the mean step of MuJoCo.
* *work*: the most that a step has counted, over what it may do
  ([limits](limits.md#many-bodies)).

## Every environment

{actions} random actions in each environment, with the default settings.
{len(played)} load and run, {len(refused)} are refused.
{_verdict(played)}

{_tours(played)}
Refused:

{_refusals(refused)}"""


def _motions(robots: dict[tuple[str, float], Falls]) -> str:
    """Returns the table of what robots did."""
    heading = (
        "robot",
        "restitution",
        "warnings",
        "deepest",
        "mean",
        "fastest",
        "end",
        "impacts",
        "lying",
        "adds energy",
    )
    rows = []
    for (name, restitution), (ours, stock) in robots.items():
        worst = max(ours, key=lambda fall: fall.energy_part)
        rows.append(
            (
                name,
                f"{restitution:g}",
                str(sum(fall.warnings for fall in ours)),
                _pair(1e3 * _most(ours, "deepest"), 1e3 * _most(stock, "deepest")),
                _pair(1e3 * _mean(ours, "deepest"), 1e3 * _mean(stock, "deepest")),
                _pair(_most(ours, "fastest"), _most(stock, "fastest")),
                _pair(_most(ours, "end"), _most(stock, "end")),
                f"{_mean(ours, 'impacts'):.0f}",
                f"{_most(ours, 'lying'):.3g}",
                f"{worst.energy:.1g}, {worst.energy_part:.1g}",
            )
        )
    return markdown_table(heading, rows)


def _costs(robots: dict[tuple[str, float], Falls]) -> str:
    """Returns the table of costs."""
    rows = []
    for (name, restitution), (ours, _) in robots.items():
        costs = [fall.costs for fall in ours if fall.costs is not None]
        rows.append(
            (
                name,
                f"{restitution:g}",
                f"{np.mean([cost.mean for cost in costs]):.2f}",
                f"{np.mean([cost.still for cost in costs]):.2f}",
                f"{100 * np.mean([cost.struck for cost in costs]):.0f} %",
                f"{np.mean([cost.impact for cost in costs]):.1f}",
                f"{max(cost.worst for cost in costs):.0f}",
                f"{_most(ours, 'work'):.2f}",
            )
        )
    return markdown_table(
        (
            "robot",
            "restitution",
            "mean",
            "without impact",
            "steps with impacts",
            "their mean",
            "worst",
            "work",
        ),
        rows,
    )


def _verdict(played: Sequence[Tour]) -> str:
    """Returns a sentence on warnings."""
    new = [
        one.scene.name
        for one in played
        if one.ours and one.stock and one.ours.warnings > one.stock.warnings
    ]
    if not new:
        return "None warns of anything that it does not warn of with MuJoCo's contacts."
    return f"More warnings than with MuJoCo's contacts: {', '.join(new)}."


def _tours(played: Sequence[Tour]) -> str:
    """Returns the table of environments."""
    rows = [
        (
            one.scene.library,
            one.scene.name,
            f"{one.ours.warnings} / {one.stock.warnings}",
            _pair(1e3 * one.ours.deepest, 1e3 * one.stock.deepest),
            _pair(one.ours.fastest, one.stock.fastest),
        )
        for one in played
        if one.ours and one.stock
    ]
    return markdown_table(
        ("library", "environment", "warnings", "deepest [mm]", "fastest"), rows
    )


def _refusals(refused: Sequence[Tour]) -> str:
    """Returns a list of reasons and the environments that have them."""
    reasons: dict[str, list[str]] = {}
    for one in refused:
        reasons.setdefault(one.refusal, []).append(one.scene.name)
    return "".join(
        f"* `{reason}`: {', '.join(names)}\n" for reason, names in reasons.items()
    )


def _pair(ours: float, stock: float) -> str:
    """Returns two numbers."""
    return f"{ours:.3g} / {stock:.3g}"


def _most(runs: Sequence[Fall], name: str) -> float:
    """Returns the largest of an attribute."""
    return max(float(getattr(fall, name)) for fall in runs)


def _mean(runs: Sequence[Fall], name: str) -> float:
    """Returns the mean of an attribute."""
    return float(np.mean([getattr(fall, name) for fall in runs]))
