"""Picture of a comparison of any scene: paths, velocities, energies, costs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mujoco_impact.comparison import AS_IS, OURS, Comparison, MethodResult
from mujoco_impact.plot import panels
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PATHS = 8
"""Bodies whose paths are drawn: of the first impact, then those that move most."""

MOST_SPEEDS = 3
"""Bodies whose speeds are drawn around the first impact."""

FLAT = 0.02
"""Part of the longest way that a second direction needs to be worth an axis."""

BEFORE, LEAST_AFTER = 5, 10
"""Samples drawn before the first impact, and at least after it."""

_STYLES = ("solid", "dashed", "dotted")


def scene_figure(comparison: Comparison) -> Figure:
    """Returns the picture: paths above; velocities, energies and costs below."""
    from matplotlib.figure import Figure

    shown = _shown(comparison)
    bodies, names = _bodies(comparison)
    figure = Figure(figsize=(14.0, 8.6), layout="constrained")
    grid: Any = figure.subplots(2, 3)
    axes = _plane(comparison, bodies)
    paths: list[Any] = []
    for method, axis in zip(shown, grid[0], strict=False):
        paths = _draw_paths(comparison, method, axis, bodies, axes) or paths
    for axis in grid[0][len(shown) :]:
        axis.axis("off")
    grid[0][0].legend(paths, names, fontsize=8, loc="best", framealpha=0.6)
    _draw_velocities(comparison, shown, grid[1][0])
    panels.draw_energies(comparison, grid[1][1])
    panels.draw_costs(comparison, grid[1][2])
    handles, labels = grid[1][1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=9)
    figure.suptitle(panels.title_of(comparison), fontsize=13)
    return figure


def _shown(comparison: Comparison) -> list[MethodResult]:
    """Returns ours, MuJoCo's default, and its best setting.

    Without a reference that is the one whose impacts take the energy nearest to what
    ours take.
    """
    best = comparison.best_tuned()
    ours = comparison.method(OURS).seen
    if best is None and ours is not None:
        tuned = [one for one in comparison.methods if one.name not in (OURS, AS_IS)]
        ran = [(abs(one.seen.lost - ours.lost), one) for one in tuned if one.seen]
        best = min(ran, key=lambda pair: pair[0])[1] if ran else None
    names = {OURS, AS_IS} | ({best.name} if best is not None else set())
    return [one for one in comparison.methods if one.name in names]


def _bodies(comparison: Comparison) -> tuple[list[int], list[str]]:
    """Returns ids and names of the bodies to draw."""
    seen = comparison.method(OURS).seen
    bodies = list(comparison.first.bodies)
    if seen is not None:
        ways = np.ptp(seen.positions, axis=0).max(axis=1)
        moving = np.flatnonzero(ways > FLAT * ways.max())
        others = sorted(moving.tolist(), key=lambda body: -ways[body])
        bodies += [body for body in others if body not in bodies]
    bodies = bodies[:MOST_PATHS]
    names = [comparison.model.body(body).name or f"body {body}" for body in bodies]
    return bodies, [panels.literal(name) for name in names]


def _plane(comparison: Comparison, bodies: Sequence[int]) -> tuple[int, ...]:
    """Returns the one or two of x, y, z in which the bodies move in our motion."""
    seen = comparison.method(OURS).seen
    if seen is None:
        return (0, 2)
    ways = np.ptp(seen.positions[:, bodies].reshape(-1, 3), axis=0)
    own = np.ptp(seen.positions[:, bodies], axis=0).max(axis=0)
    first, second = sorted(np.argsort(-own)[:2].tolist())
    longest, other = (first, second) if own[first] >= own[second] else (second, first)
    if own[other] < FLAT * max(own[longest], ways[longest]):
        return (int(longest),)
    return (int(first), int(second))


def _draw_paths(
    comparison: Comparison,
    method: MethodResult,
    axis: Axes,
    bodies: Sequence[int],
    axes: tuple[int, ...],
) -> list[Any]:
    """Draws the paths of one method, a dot where they start; returns their lines."""
    weight = "bold" if method.name == OURS else "normal"
    axis.set_title(method.name, fontsize=10, fontweight=weight)
    axis.grid(alpha=0.25)
    if method.trajectory is None or method.seen is None:
        panels.say(axis, method.failure)
        return []
    lines: list[Any] = []
    time = method.trajectory.time
    for body, colour in zip(bodies, _colours(len(bodies)), strict=True):
        path = method.seen.positions[:, body]
        across = path[:, axes[0]] if len(axes) == 2 else time
        along = path[:, axes[-1]]
        lines += axis.plot(across, along, color=colour, linewidth=1.2)
        axis.plot(across[:1], along[:1], "o", color=colour, markersize=4)
    letters = "xyz"
    if len(axes) == 1:
        axis.set(xlabel="time [s]", ylabel=f"{letters[axes[0]]} [m]")
        return lines
    axis.set(xlabel=f"{letters[axes[0]]} [m]", ylabel=f"{letters[axes[1]]} [m]")
    _limit(comparison, axis, bodies, axes)
    return lines


def _limit(
    comparison: Comparison, axis: Axes, bodies: Sequence[int], axes: tuple[int, ...]
) -> None:
    """Gives all panels the frame that our motion needs, of equal scales."""
    seen = comparison.method(OURS).seen
    if seen is None:
        return
    points = seen.positions[:, bodies][:, :, list(axes)].reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    room = 0.08 * float((high - low).max())
    axis.set_xlim(low[0] - room, high[0] + room)
    axis.set_ylim(low[1] - room, high[1] + room)
    if (high - low).min() > 0.1 * (high - low).max():
        axis.set_aspect("equal", adjustable="box")


def _draw_velocities(
    comparison: Comparison, shown: Sequence[MethodResult], axis: Axes
) -> None:
    """Draws speeds around the first impact, or velocities along its line."""
    line = comparison.line()
    numbers = _struck_most(comparison)
    bodies = [comparison.first.bodies[number] for number in numbers]
    colours = _colours(max(len(bodies), 2))
    first = comparison.first
    last = max(first.before + LEAST_AFTER, first.after + LEAST_AFTER // 2)
    span = slice(max(0, first.before - BEFORE), last + 3 * LEAST_AFTER)
    for method, style in zip(shown, _STYLES, strict=False):
        if method.trajectory is None or method.seen is None:
            continue
        time = 1e3 * (method.trajectory.time[span] - first.time)
        for body, colour in zip(bodies, colours, strict=False):
            velocity = method.seen.velocities[span, body]
            speed = (
                np.linalg.norm(velocity, axis=1) if line is None else velocity @ line
            )
            axis.plot(time, speed, color=colour, linestyle=style, linewidth=1.4)
    axis.axvline(0.0, color="grey", linewidth=0.8)
    lines: list[Any] = [
        axis.plot(
            [], [], color=colour, label=panels.literal(comparison.bodies[number])
        )[0]
        for number, colour in zip(numbers, colours, strict=False)
    ]
    lines += [
        axis.plot([], [], color="black", linestyle=style, label=method.name)[0]
        for method, style in zip(shown, _STYLES, strict=False)
    ]
    axis.legend(handles=lines, fontsize=7, loc="best")
    axis.set(
        xlabel="time after the first impact [ms]",
        ylabel="speed [m/s]" if line is None else "velocity along its line [m/s]",
        title="Around the first impact",
    )
    axis.grid(alpha=0.25)


def _struck_most(comparison: Comparison) -> list[int]:
    """Returns which bodies of the first impact change their velocity most."""
    ours = comparison.method(OURS)
    if ours.before is None or ours.after is None:
        return []
    change = np.linalg.norm(ours.after - ours.before, axis=1)
    return sorted(np.argsort(-change)[:MOST_SPEEDS].tolist())


def _colours(count: int) -> Array:
    """Returns one colour a body."""
    import matplotlib as mpl

    colours: Array = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, count))
    return colours
