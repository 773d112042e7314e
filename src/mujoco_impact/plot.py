"""Pictures of a comparison (needs matplotlib)."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mujoco_impact.comparing.rows import row_samples
from mujoco_impact.comparison import OURS, Comparison, MethodResult
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.pendulums import PendulumRow
from mujoco_impact.text import printable
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mujoco_impact.reference import ReferenceTrajectory

MOST_CURVES = 10
"""Balls or geoms drawn at most in one panel."""

PANEL_COLUMNS = 4

REFERENCE_POINTS = 1500

SMALLEST_ERROR = 1e-9
"""Errors below it are drawn at it: the axis is logarithmic."""

COLOURS = ("crimson", "black", "tab:blue", "tab:green", "tab:orange", "tab:purple")
MARKERS = ("*", "o", "s", "^", "D", "v")
"""One for each method, in the order of the comparison."""


def plot_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> Path:
    """Draws motions, velocities, energies, and error against run time.

    A row of pendulums shows the angles of every method over time; another scene the
    paths of its bodies in the plane in which they move.

    Args:
        comparison: What to draw.
        path: PNG (or other image) file to write.

    Returns:
        The path written.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    require_matplotlib()
    target = Path(path)
    if comparison.row:
        figure = _row_figure(comparison)
    else:
        from mujoco_impact.plot_scene import scene_figure

        figure = scene_figure(comparison)
    with replacing(target) as part:
        figure.savefig(part, dpi=130, format=target.suffix[1:] or "png")
    return target


def _row_figure(comparison: Comparison) -> Figure:
    """Returns the picture of a row: angles above, energies and run times below."""
    from matplotlib.figure import Figure

    rows = -(-(len(comparison.methods) + 1) // PANEL_COLUMNS)
    figure = Figure(figsize=(14.0, 2.8 * rows + 4.4), layout="constrained")
    halves: Any = figure.subfigures(2, 1, height_ratios=[2.8 * rows, 4.4])
    top, bottom = halves
    grid = top.subplots(rows, PANEL_COLUMNS, sharex=True, sharey=True, squeeze=False)
    _draw_motions(comparison, grid.ravel())
    left, right = bottom.subplots(1, 2)
    draw_energies(comparison, left)
    draw_costs(comparison, right)
    handles, labels = left.get_legend_handles_labels()
    bottom.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=9)
    figure.suptitle(title_of(comparison), fontsize=13)
    return figure


def _draw_motions(comparison: Comparison, axes: Sequence[Axes]) -> None:
    """Draws one panel per method, after the reference, and names the curves."""
    panels = list(axes)
    if comparison.reference is not None:
        _draw_reference(comparison.reference, panels.pop(0))
    for method, axis in zip(comparison.methods, panels, strict=False):
        weight = "bold" if method.name == OURS else "normal"
        axis.set_title(method.name, fontsize=10, fontweight=weight)
        if method.trajectory is None:
            say(axis, method.failure)
            continue
        curves = np.degrees(_row_of(comparison).angles(method.trajectory.qpos))
        _draw_curves(axis, method.trajectory.time, curves)
    used = len(comparison.methods) + len(axes) - len(panels)
    for panel, axis in enumerate(axes):
        _dress(axis, panel, used, "angle [deg]")
    count = _row_of(comparison).chain.count
    names = [f"ball {ball + 1}" for ball in range(count)][:MOST_CURVES]
    place = axes[-1] if used < len(axes) else panels[0]
    columns = 1 + (len(names) > MOST_CURVES // 2)
    lines = panels[0].lines
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


def draw_energies(comparison: Comparison, axis: Axes) -> None:
    """Draws the change of energy of every method."""
    for number, method in enumerate(comparison.methods):
        if method.trajectory is None:
            continue
        time, change = _energy_change(comparison, method)
        axis.plot(time, change, label=method.name, **line_style(number))
    axis.set_yscale("symlog", linthresh=1e-3)
    axis.set(
        xlabel="time [s]",
        ylabel="energy change, relative",
        title="Energy (contacts store it while they last)",
    )
    axis.grid(alpha=0.25)


def _energy_change(comparison: Comparison, method: MethodResult) -> tuple[Array, Array]:
    """Returns times and relative changes of energy, free of the half-step offset."""
    motion, seen = method.trajectory, method.seen
    if motion is None or seen is None:
        return np.zeros(0), np.zeros(0)
    if comparison.row:
        time, angles, velocities = row_samples(comparison.row, motion)
        total = comparison.row.chain.mechanical_energy(angles, velocities)
        return time, (total - total[0]) / total[0]
    scale = comparison.energy_scale or 1.0
    return motion.time, (seen.energy - seen.energy[0]) / scale


def draw_costs(comparison: Comparison, axis: Axes) -> None:
    """Draws the error of the first impact against run time."""
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    timed = [method for method in comparison.methods if math.isfinite(method.run_time)]
    if not timed:
        say(axis, "run times were not measured")
        return
    if all(method.velocity_error is None for method in timed):
        _draw_run_times(comparison, axis)
        return
    for number, method in enumerate(comparison.methods):
        error = method.velocity_error
        if error is not None and method in timed:
            shown = max(error, SMALLEST_ERROR)
            axis.plot(method.run_time * 1e3, shown, **_marker_style(number))
    axis.set(
        xscale="log",
        yscale="log",
        xlabel="run time of one simulated second [ms]",
        ylabel="velocity error / impact speed",
        title="Error of the first impact (lower left is better)",
    )
    axis.margins(x=0.15, y=0.15)
    axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.grid(alpha=0.25)


def _draw_run_times(comparison: Comparison, axis: Axes) -> None:
    """Draws run times alone, where errors are not known."""
    for number, method in enumerate(comparison.methods):
        if not method.failure:
            axis.barh(method.name, method.run_time * 1e3, color=COLOURS[number])
    axis.invert_yaxis()
    axis.set(xlabel="run time of one simulated second [ms]", title="Run time")


def title_of(comparison: Comparison) -> str:
    """Returns the title of the picture."""
    return (
        f"{literal(comparison.scene)} from {literal(comparison.start)}: timestep "
        f"{comparison.timestep * 1e3:g} ms, {comparison.integrator}, "
        f"MuJoCo {comparison.mujoco_version}"
    )


def line_style(number: int) -> dict[str, Any]:
    """Returns the line style of a method: ours, the first, stands out."""
    width = 2.4 if number == 0 else 1.1
    return {"color": COLOURS[number], "linewidth": width, "zorder": 5 - number}


def _marker_style(number: int) -> dict[str, Any]:
    """Returns the marker style of a method: ours, the first, stands out."""
    size = 12 if number == 0 else 8
    return {"color": COLOURS[number], "marker": MARKERS[number], "markersize": size}


def literal(text: str) -> str:
    """Returns text that matplotlib has letters for, and takes for no formula."""
    return printable(text).replace("$", r"\$")


def say(axis: Axes, text: str) -> None:
    """Writes a sentence in an empty panel."""
    axis.text(
        0.5,
        0.5,
        literal(text),
        transform=axis.transAxes,
        ha="center",
        va="center",
        wrap=True,
        fontsize=8,
    )
