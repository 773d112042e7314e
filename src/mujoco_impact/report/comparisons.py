"""Report of a comparison."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from mujoco_impact.comparison import OURS, Comparison, MethodResult
from mujoco_impact.report import figures, motions
from mujoco_impact.report.page import Page, Section
from mujoco_impact.report.tables import html_table, of_terminal
from mujoco_impact.text import printable
from mujoco_impact.trajectory import Array

PANELS_ABREAST = 3

AXES = ("x_range", "y_range")
"""What the panels share."""


def comparison_page(
    comparison: Comparison,
    tables: Iterable[Table],
    *,
    command: str,
    notes: Iterable[str] = (),
    video: Path | None = None,
) -> Page:
    """Returns the page of a comparison.

    Args:
        comparison: What to show.
        tables: The tables of the terminal.
        command: The command that made the page.
        notes: Sentences to stand above.
        video: A video to hold.
    """
    sections = [Section("Numbers", "".join(of_terminal(table) for table in tables))]
    if video is not None:
        sections.append(Section("Video", video=video))
    sections.append(Section("Motion", plot=_motions(comparison)))
    sections.append(Section("Energy", plot=_energies(comparison)))
    sections.append(Section("Run time", plot=_costs(comparison)))
    sections.append(Section("Settings", _settings(comparison)))
    return Page(
        title=f"{comparison.scene}: MuJoCo's contacts and mujoco-impact",
        command=command,
        facts={
            "start": comparison.start,
            "duration": f"{comparison.duration:g} s",
            "timestep": f"{comparison.timestep * 1e3:g} ms",
            "integrator": comparison.integrator,
            "impact speed": f"{comparison.impact_speed:.4g} m/s",
            "settings": comparison.methods[0].setting,
        },
        sections=tuple(sections),
        notes=(*notes, *(remark.text for remark in comparison.remarks)),
    )


def _settings(comparison: Comparison) -> str:
    """Returns what each method sets."""
    rows = [(method.name, method.setting) for method in comparison.methods]
    return html_table(("method", "setting"), rows, left=(True, True))


def _motions(comparison: Comparison) -> Any:
    """Returns one panel per method, all of the same axes: angles, else speeds."""
    what = "angle [deg]" if comparison.row else "speed [m/s]"
    plots: list[Any] = []
    for name, time, curves in _curves(comparison):
        shared = {axis: getattr(plots[0], axis) for axis in AXES} if plots else {}
        plot = figures.new_figure(name, "time [s]", what, height=260, **shared)
        figures.add_curves(plot, time, curves)
        # one legend for all
        if plots:
            plot.legend[0].visible = False
        else:
            figures.put_legend_inside(plot)
        plots.append(plot)
    return figures.grid(plots, columns=PANELS_ABREAST)


def _curves(comparison: Comparison) -> list[tuple[str, Array, dict[str, Array]]]:
    """Returns names, times and curves of the panels."""
    ran = [one for one in comparison.methods if one.trajectory is not None]
    row = comparison.row
    panels: list[tuple[str, Array, dict[str, Array]]] = []
    if row is not None:
        names = [f"ball {ball + 1}" for ball in range(row.chain.count)]
        if comparison.reference is not None:
            time = np.linspace(0.0, comparison.duration, figures.MOST_POINTS)
            angles = np.degrees(comparison.reference(time)[0])
            panels.append(
                ("Hertz reference", time, dict(zip(names, angles.T, strict=True)))
            )
        for method in ran:
            motion = _known(method)
            angles = np.degrees(row.angles(motion.qpos))
            curves = dict(zip(names, angles.T, strict=True))
            panels.append((method.name, motion.time, curves))
        return panels
    bodies = motions.moving_bodies(comparison.model, _known(ran[0]))
    names = [printable(one) for one in motions.names_of(comparison.model, bodies)]
    for method in ran:
        seen = motions.motion_of(comparison.model, _known(method), bodies)
        curves = dict(zip(names, seen.speeds.T, strict=True))
        panels.append((method.name, seen.time, curves))
    return panels


def _known(method: MethodResult) -> Any:
    """Returns the motion of a method that did not fail."""
    assert method.trajectory is not None
    return method.trajectory


def _energies(comparison: Comparison) -> Any:
    """Returns the change of energy of every method over the largest kinetic energy."""
    plot = figures.new_figure(
        "Change of energy over the largest energy of motion of ours",
        "time [s]",
        "change",
    )
    scale = comparison.energy_scale
    for method in comparison.methods:
        motion = method.trajectory
        if motion is None:
            continue
        total = (motion.total_energy - motion.total_energy[0]) / (scale or 1.0)
        colours = (_colour(comparison, method),)
        figures.add_curves(
            plot, motion.time, {method.name: total}, colours=colours, wide=OURS
        )
    return plot


def _costs(comparison: Comparison) -> Any:
    """Returns error against run time, or run times alone if no error is known."""
    timed = [one for one in comparison.methods if np.isfinite(one.run_time)]
    known = [one for one in timed if one.velocity_error is not None]
    unit = "run time of a simulated second [ms]"
    if not known:
        names = [method.name for method in timed]
        values = [method.run_time * 1e3 for method in timed]
        colours = [_colour(comparison, method) for method in timed]
        return figures.bars("Run time", unit, names, values, colours=colours)
    error = "velocity error / impact speed"
    plot = figures.new_figure(
        "Error of the first impact: towards the lower left is better",
        unit,
        error,
        x_axis_type="log",
        y_axis_type="log",
    )
    for method in known:
        columns: dict[str, list[Any]] = {
            unit: [method.run_time * 1e3],
            error: [method.velocity_error],
            "setting": [method.setting],
        }
        colour = _colour(comparison, method)
        figures.add_points(plot, columns, name=method.name, colour=colour)
    return plot


def _colour(comparison: Comparison, method: MethodResult) -> str:
    """Returns the colour of a method, the same in all plots."""
    number = [one.name for one in comparison.methods].index(method.name)
    return figures.COLOURS[number % len(figures.COLOURS)]
