"""Picture of a comparison of a row of pendulums: angles, energies, costs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mujoco_impact.comparing.pendulums import PendulumRow
from mujoco_impact.comparison import OURS, Comparison
from mujoco_impact.plot import panels
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mujoco_impact.reference import ReferenceTrajectory

MOST_CURVES = 10
"""Balls or geoms drawn at most in one panel."""

PANEL_COLUMNS = 4

REFERENCE_POINTS = 1500


def row_figure(comparison: Comparison) -> Figure:
    """Returns the picture of a row: angles above, energies and run times below."""
    from matplotlib.figure import Figure

    rows = -(-(len(comparison.methods) + 1) // PANEL_COLUMNS)
    figure = Figure(figsize=(14.0, 2.8 * rows + 4.4), layout="constrained")
    halves: Any = figure.subfigures(2, 1, height_ratios=[2.8 * rows, 4.4])
    top, bottom = halves
    grid = top.subplots(rows, PANEL_COLUMNS, sharex=True, sharey=True, squeeze=False)
    _draw_motions(comparison, grid.ravel())
    left, right = bottom.subplots(1, 2)
    panels.draw_energies(comparison, left)
    panels.draw_costs(comparison, right)
    handles, labels = left.get_legend_handles_labels()
    bottom.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=9)
    figure.suptitle(panels.title_of(comparison), fontsize=13)
    return figure


def _draw_motions(comparison: Comparison, axes: Sequence[Axes]) -> None:
    """Draws one panel per method, after the reference, and names the curves."""
    free = list(axes)
    if comparison.reference is not None:
        _draw_reference(comparison.reference, free.pop(0))
    for method, axis in zip(comparison.methods, free, strict=False):
        weight = "bold" if method.name == OURS else "normal"
        axis.set_title(method.name, fontsize=10, fontweight=weight)
        if method.trajectory is None:
            panels.say(axis, method.failure)
            continue
        curves = np.degrees(_row_of(comparison).angles(method.trajectory.qpos))
        _draw_curves(axis, method.trajectory.time, curves)
    used = len(comparison.methods) + len(axes) - len(free)
    for panel, axis in enumerate(axes):
        _dress(axis, panel, used, "angle [deg]")
    count = _row_of(comparison).chain.count
    names = [f"ball {ball + 1}" for ball in range(count)][:MOST_CURVES]
    place = axes[-1] if used < len(axes) else free[0]
    columns = 1 + (len(names) > MOST_CURVES // 2)
    lines = free[0].lines
    place.legend(lines, names, loc="center", fontsize=9, ncols=columns, frameon=False)


def _dress(axis: Axes, panel: int, used: int, what: str) -> None:
    """Labels the outer axes of one panel, or hides a panel that is not used."""
    if panel >= used:
        axis.axis("off")
        return
    if panel % PANEL_COLUMNS == 0:
        axis.set_ylabel(what)
    if panel + PANEL_COLUMNS >= used:
        axis.set_xlabel("time [s]")
        axis.tick_params(labelbottom=True)
    axis.grid(alpha=0.25)


def _draw_reference(reference: ReferenceTrajectory, axis: Axes) -> None:
    """Draws the Hertz reference."""
    axis.set_title("Hertz reference", fontsize=10, fontweight="bold")
    time = np.linspace(0.0, reference.duration, REFERENCE_POINTS)
    _draw_curves(axis, time, np.degrees(reference(time)[0]))


def _row_of(comparison: Comparison) -> PendulumRow:
    """Returns the row of a comparison that has one."""
    if comparison.row is None:
        raise ValueError("the scene is no row of pendulums")
    return comparison.row


def _draw_curves(axis: Axes, time: Array, values: Array) -> None:
    """Draws the first columns of an array against time."""
    import matplotlib as mpl

    count = min(values.shape[1], MOST_CURVES)
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.9, count))
    for column in range(count):
        axis.plot(time, values[:, column], color=colours[column], linewidth=1.0)
