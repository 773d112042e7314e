"""Report of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco

from mujoco_impact.impact_list import Bounces, Meeting, listed, met
from mujoco_impact.report import figures, motions
from mujoco_impact.report.page import Page, Section
from mujoco_impact.report.tables import html_table
from mujoco_impact.text import printable
from mujoco_impact.trajectory import Trajectory

MOST_ROWS = 500
"""Impacts in the table at most: the first."""

MOST_DOTS = 5000
"""Impacts in the plot at most: the largest."""

MOST_PAIRS = 12
"""Pairs of geoms with a colour of their own."""


def run_page(
    model: mujoco.MjModel,
    trajectory: Trajectory,
    *,
    scene: str,
    command: str,
    settings: str,
    video: Path | None = None,
) -> Page:
    """Returns the page of a run.

    Args:
        model: The model that was run.
        trajectory: The motion.
        scene: Its name.
        command: The command that made the page.
        settings: Settings of the impact law.
        video: A video to hold.
    """
    bodies = motions.moving_bodies(model, trajectory)
    motion = motions.motion_of(model, trajectory, bodies)
    names = [printable(name) for name in motions.names_of(model, bodies)]
    sections = [Section("Impacts", _impact_tables(trajectory))]
    if video is not None:
        sections.append(Section("Video", video=video))
    speeds = figures.new_figure("Speeds of the bodies", "time [s]", "speed [m/s]")
    curves = dict(zip(names, motion.speeds.T, strict=True))
    figures.add_curves(speeds, motion.time, curves)
    plots = [speeds, _energies(trajectory)]
    if any(one.impulse > 0 for one in trajectory.impacts):
        plots.append(_impulses(trajectory))
    for plot in plots[1:]:
        plot.x_range = speeds.x_range
    sections.append(Section("Motion", plot=figures.grid(plots, columns=1)))
    first, second = motions.plane_of(motion)
    sections.append(Section("Paths", plot=_paths(motion, names, first, second)))
    return Page(
        title=f"{scene}: {trajectory.time[-1]:g} s",
        command=command,
        facts=facts_of(trajectory, settings),
        sections=tuple(sections),
        notes=tuple(remark.text for remark in trajectory.remarks),
    )


def facts_of(trajectory: Trajectory, settings: str) -> dict[str, str]:
    """Returns what a run was made of."""
    return {
        "start": trajectory.start,
        "duration": f"{trajectory.time[-1]:g} s",
        "timestep": f"{trajectory.timestep * 1e3:g} ms",
        "integrator": trajectory.integrator,
        "settings": settings,
    }


def _impact_tables(trajectory: Trajectory) -> str:
    """Returns the impacts: real ones in a table, bouncing out in a line each."""
    end = float(trajectory.time[-1])
    meetings, bounces = listed(
        trajectory.impacts, timestep=trajectory.timestep, end=end
    )
    if not meetings and not bounces:
        return "<p>There was no impact.</p>"
    return _meeting_table(meetings) + _bounce_table(bounces)


def _meeting_table(meetings: Sequence[Meeting]) -> str:
    """Returns real impacts, one row each."""
    rows = [
        (f"{one.time:.6f}", " - ".join(one.geoms), f"{one.closing_speed:.4g}",
         f"{one.impulse:.4g}", f"{one.peak:.4g}", str(one.points))
        for one in meetings[:MOST_ROWS]
    ]  # fmt: skip
    headings = ("time [s]", "geoms", "closing speed\n[m/s]", "impulse\n[N s]",
                "peak\n[N]", "points")  # fmt: skip
    left = (False, True, False, False, False, False)
    if not rows:
        return ""
    more = len(meetings) - len(rows)
    rest = f"<p>and {more} more (--impacts FILE.csv has all)</p>" if more else ""
    return html_table(headings, rows, left=left) + rest


def _bounce_table(bounces: Sequence[Bounces]) -> str:
    """Returns what bounced out, one row each."""
    rows = [(str(one),) for one in bounces]
    return html_table(("bouncing out",), rows, left=(True,)) if rows else ""


def _energies(trajectory: Trajectory) -> Any:
    """Returns the plot of the energies."""
    plot = figures.new_figure("Energy", "time [s]", "energy [J]")
    potential, kinetic = trajectory.energy.T
    # of potential energy only changes have a meaning
    lowest = potential.min()
    curves = {"total": potential + kinetic - lowest, "kinetic": kinetic,
              "potential, above its lowest": potential - lowest}  # fmt: skip
    figures.add_curves(plot, trajectory.time, curves, wide="total")
    return plot


def _impulses(trajectory: Trajectory) -> Any:
    """Returns the plot of the impulses."""
    plot = figures.new_figure(
        "Impulses", "time [s]", "impulse [N s]", y_axis_type="log"
    )
    everything = met(trajectory.impacts, trajectory.timestep)
    largest = sorted(everything, key=lambda one: -one.impulse)[:MOST_DOTS]
    meetings = sorted(largest, key=lambda one: one.time)
    sizes = [one.impulse for one in meetings if one.impulse > 0]
    # a logarithmic axis of less than a decade has no room for its numbers
    plot.y_range.start, plot.y_range.end = min(sizes) / 3, max(sizes) * 3
    pairs = list(dict.fromkeys(one.geoms for one in meetings))
    groups = [[pair] for pair in pairs[:MOST_PAIRS]]
    if pairs[MOST_PAIRS:]:
        groups.append(pairs[MOST_PAIRS:])
    for number, group in enumerate(groups):
        mine = [one for one in meetings if one.geoms in group and one.impulse > 0]
        if not mine:
            continue
        columns: dict[str, Sequence[Any]] = {
            "time [s]": [one.time for one in mine],
            "impulse [N s]": [one.impulse for one in mine],
            "closing speed [m/s]": [one.closing_speed for one in mine],
            "peak [N]": [one.peak for one in mine],
            "geoms": [printable(" - ".join(one.geoms)) for one in mine],
        }
        name = columns["geoms"][0] if len(group) == 1 else f"{len(group)} other pairs"
        colour = figures.COLOURS[number % len(figures.COLOURS)]
        figures.add_points(plot, columns, name=str(name), colour=colour)
    return plot


def _paths(motion: motions.Motion, names: list[str], first: int, second: int) -> Any:
    """Returns the plot of the paths in the plane in which the bodies move."""
    letters = "xyz"
    plot = figures.new_figure(
        "Paths of the centres of mass",
        f"{letters[first]} [m]",
        f"{letters[second]} [m]",
        match_aspect=True,
        height=420,
    )
    for number, name in enumerate(names):
        path = motion.positions[:, number]
        colours = (figures.COLOURS[number % len(figures.COLOURS)],)
        figures.add_curves(
            plot, path[:, first], {name: path[:, second]}, colours=colours
        )
    return plot
