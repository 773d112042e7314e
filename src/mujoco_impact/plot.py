"""Pictures of a comparison (needs matplotlib)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from mujoco_impact.compare import row_samples
from mujoco_impact.comparison import OURS, Comparison
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.printable import printable
from mujoco_impact.trajectory import Array, Trajectory

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
    """Draws the motion of every method, the energies, and error against run time.

    Args:
        comparison: What to draw.
        path: PNG (or other image) file to write.

    Returns:
        The path written.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    figure = _new_figure(comparison)
    target = Path(path)
    with replacing(target) as part:
        figure.savefig(part, dpi=130, format=target.suffix[1:] or "png")
    return target


def _new_figure(comparison: Comparison) -> Figure:
    """Returns the whole figure: motions above, energies and run times below."""
    require_matplotlib()
    from matplotlib.figure import Figure

    rows = -(-(len(comparison.methods) + 1) // PANEL_COLUMNS)
    figure = Figure(figsize=(14.0, 2.8 * rows + 4.4), layout="constrained")
    halves: Any = figure.subfigures(2, 1, height_ratios=[2.8 * rows, 4.4])
    top, bottom = halves
    grid = top.subplots(rows, PANEL_COLUMNS, sharex=True, sharey=True, squeeze=False)
    _draw_motions(comparison, grid.ravel())
    left, right = bottom.subplots(1, 2)
    _draw_energies(comparison, left)
    _draw_costs(comparison, right)
    handles, labels = left.get_legend_handles_labels()
    bottom.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=9)
    figure.suptitle(
        f"{_literal(comparison.scene)}: timestep {comparison.timestep * 1e3:g} ms, "
        f"{comparison.integrator}, MuJoCo {comparison.mujoco_version}",
        fontsize=13,
    )
    return figure


def _draw_motions(comparison: Comparison, axes: Sequence[Axes]) -> None:
    """Draws one panel per method, after the reference, and names the curves."""
    panels = list(axes)
    if comparison.reference is not None:
        _draw_reference(comparison.reference, panels.pop(0))
    coordinate = _main_coordinate(comparison)
    for method, axis in zip(comparison.methods, panels, strict=False):
        weight = "bold" if method.name == OURS else "normal"
        axis.set_title(method.name, fontsize=10, fontweight=weight)
        if method.trajectory is None:
            _say(axis, method.failure)
            continue
        curves = _curves(comparison, method.trajectory, coordinate)
        _draw_curves(axis, method.trajectory.time, curves)
    used = len(comparison.methods) + len(axes) - len(panels)
    what = "angle [deg]" if comparison.row else f"{'xyz'[coordinate]} [m]"
    for panel, axis in enumerate(axes):
        _dress(axis, panel, used, what)
    names = _curve_names(comparison)
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


def _curves(comparison: Comparison, motion: Trajectory, coordinate: int) -> Array:
    """Returns angles [deg] of a row, else one coordinate of the owned geoms [m]."""
    if comparison.row:
        angles: Array = np.degrees(comparison.row.angles(motion.qpos))
        return angles
    return _positions(comparison, motion)[:, :, coordinate]


def _curve_names(comparison: Comparison) -> list[str]:
    """Returns the names of the curves of a panel."""
    if comparison.row:
        names = [f"ball {ball + 1}" for ball in range(comparison.row.chain.count)]
    else:
        names = [_literal(geom) for geom in comparison.geoms]
    return names[:MOST_CURVES]


def _main_coordinate(comparison: Comparison) -> int:
    """Returns which of x, y, z the owned geoms move along most in our run."""
    motion = comparison.methods[0].trajectory
    if comparison.row or motion is None:
        return 0
    spread = np.ptp(_positions(comparison, motion), axis=0).max(axis=0)
    return int(np.argmax(spread))


def _positions(comparison: Comparison, motion: Trajectory) -> Array:
    """Returns the centres of the owned geoms [m], shape (n_samples, n_geoms, 3)."""
    model = comparison.model
    data = mujoco.MjData(model)
    geoms = [model.geom(name).id for name in comparison.geoms[:MOST_CURVES]]
    positions = np.empty((len(motion.time), len(geoms), 3))
    for sample, qpos in enumerate(motion.qpos):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        positions[sample] = data.geom_xpos[geoms]
    return positions


def _draw_curves(axis: Axes, time: Array, values: Array) -> None:
    """Draws the first columns of an array against time."""
    import matplotlib as mpl

    count = min(values.shape[1], MOST_CURVES)
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.9, count))
    for column in range(count):
        axis.plot(time, values[:, column], color=colours[column], linewidth=1.0)


def _draw_energies(comparison: Comparison, axis: Axes) -> None:
    """Draws the change of energy of every method."""
    for number, method in enumerate(comparison.methods):
        if method.trajectory is None:
            continue
        time, change = _energy_change(comparison, method.trajectory)
        axis.plot(time, change, label=method.name, **_line_style(number))
    axis.set_yscale("symlog", linthresh=1e-3)
    axis.set(
        xlabel="time [s]",
        ylabel="energy change, relative",
        title="Energy (contacts store it while they last)",
    )
    axis.grid(alpha=0.25)


def _energy_change(comparison: Comparison, motion: Trajectory) -> tuple[Array, Array]:
    """Returns times and relative changes of energy, free of the half-step offset."""
    if comparison.row:
        time, angles, velocities = row_samples(comparison.row, motion)
        total = comparison.row.chain.mechanical_energy(angles, velocities)
        return time, (total - total[0]) / total[0]
    scale = float(motion.energy[:, 1].max()) or 1.0
    total = motion.total_energy
    return motion.time, (total - total[0]) / scale


def _draw_costs(comparison: Comparison, axis: Axes) -> None:
    """Draws the error of the first impact against run time."""
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    if comparison.reference is None:
        _draw_run_times(comparison, axis)
        return
    for number, method in enumerate(comparison.methods):
        if method.errors is not None:
            error = max(method.errors.velocity, SMALLEST_ERROR)
            axis.plot(method.run_time * 1e3, error, **_marker_style(number))
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


def _line_style(number: int) -> dict[str, Any]:
    """Returns the line style of a method: ours, the first, stands out."""
    width = 2.4 if number == 0 else 1.1
    return {"color": COLOURS[number], "linewidth": width, "zorder": 5 - number}


def _marker_style(number: int) -> dict[str, Any]:
    """Returns the marker style of a method: ours, the first, stands out."""
    size = 12 if number == 0 else 8
    return {"color": COLOURS[number], "marker": MARKERS[number], "markersize": size}


def _literal(text: str) -> str:
    """Returns text that matplotlib has letters for, and takes for no formula."""
    return printable(text).replace("$", r"\$")


def _say(axis: Axes, text: str) -> None:
    """Writes a sentence in an empty panel."""
    axis.text(
        0.5,
        0.5,
        _literal(text),
        transform=axis.transAxes,
        ha="center",
        va="center",
        wrap=True,
        fontsize=8,
    )
