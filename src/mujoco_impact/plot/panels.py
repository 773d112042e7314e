"""What pictures of any comparison hold: energies, costs, title."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from mujoco_impact.comparing.rows import row_samples
from mujoco_impact.comparison import Comparison, MethodResult
from mujoco_impact.text import printable
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SMALLEST_ERROR = 1e-9
"""Errors below it are drawn at it: the axis is logarithmic."""

COLOURS = ("crimson", "black", "tab:blue", "tab:green", "tab:orange", "tab:purple")
MARKERS = ("*", "o", "s", "^", "D", "v")
"""One for each method, in the order of the comparison."""


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
