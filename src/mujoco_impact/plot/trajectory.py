"""Picture of a run (needs matplotlib)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.impact_list import met

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mujoco_impact.trajectory import Trajectory

MOST_CURVES = 12
"""Degrees of freedom drawn at most: those that move fastest."""

MOST_PAIRS = 8
"""Pairs of geoms that the legend names at most."""


def plot_trajectory(
    trajectory: Trajectory, path: str | os.PathLike[str] | None = None
) -> Figure:
    """Draws velocities, energies and impacts over time.

    Args:
        trajectory: What to draw.
        path: File to write the picture to, or None.
    """
    require_matplotlib()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.5), layout="constrained")
    speeds, energies, impulses = figure.subplots(3, 1, sharex=True)
    _draw_velocities(trajectory, speeds)
    for name, values in zip(("potential", "kinetic"), trajectory.energy.T, strict=True):
        energies.plot(trajectory.time, values, label=name, linewidth=1.0)
    energies.plot(
        trajectory.time, trajectory.total_energy, label="total", color="black"
    )
    energies.set_ylabel("energy [J]")
    energies.legend(loc="upper right", fontsize=8)
    _draw_impulses(trajectory, impulses)
    for axis in (speeds, energies, impulses):
        axis.grid(alpha=0.25)
    if path is not None:
        target = Path(path)
        with replacing(target) as part:
            figure.savefig(part, dpi=130, format=target.suffix[1:] or "png")
    return figure


def _draw_velocities(trajectory: Trajectory, axis: Axes) -> None:
    """Draws the velocities of the degrees of freedom that move fastest."""
    fastest = np.argsort(-np.abs(trajectory.qvel).max(axis=0))[:MOST_CURVES]
    for dof in sorted(fastest.tolist()):
        axis.plot(trajectory.time, trajectory.qvel[:, dof], label=f"{dof}", lw=1.0)
    axis.set_ylabel("velocity [m/s, rad/s]")
    axis.set_title(f"{trajectory!r}"[1:-1], fontsize=10)
    axis.legend(title="qvel", loc="upper right", fontsize=7, ncols=2)


def _draw_impulses(trajectory: Trajectory, axis: Axes) -> None:
    """Draws the impulses of the impacts, pair by pair."""
    meetings = met(trajectory.impacts, trajectory.timestep)
    pairs = dict.fromkeys(one.geoms for one in meetings)
    for number, pair in enumerate(pairs):
        of_pair = [one for one in meetings if one.geoms == pair]
        axis.plot(
            [one.time for one in of_pair],
            [one.impulse for one in of_pair],
            linestyle="none",
            marker="o",
            markersize=3.0,
            label=" - ".join(pair) if number < MOST_PAIRS else "_",
        )
    if meetings:
        axis.set_yscale("log")
        axis.legend(loc="upper right", fontsize=7)
    else:
        axis.text(0.5, 0.5, "no impacts of the plugin", ha="center",
                  transform=axis.transAxes)  # fmt: skip
    axis.set(xlabel="time [s]", ylabel="impulse [N s]")
