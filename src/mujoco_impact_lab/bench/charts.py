"""Charts of error over run time (needs matplotlib)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS
from mujoco_impact_lab.bench.points import Point, front_of
from mujoco_impact_lab.bench.results import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ERRORS = {
    "velocity_error": "velocity error after the first impact / impact speed",
    "angle_rms": "angle error over 3 s, RMS [rad]",
}
"""What is drawn over the run time, and its label."""

SMALLEST_ERROR, LARGEST_ERROR = 1e-9, 2.0
"""Errors beyond them are drawn at them: what is larger has diverged."""

STYLES: dict[str, tuple[str, str]] = {
    OURS: ("crimson", "*"),
    DEFAULT: ("black", "o"),
    "mujoco-elastic": ("dimgrey", "X"),
    "mujoco-damper": ("tab:blue", "s"),
    "mujoco-compliant": ("tab:cyan", "v"),
    "mujoco-hertz": ("tab:purple", "^"),
    "sequential": ("tab:olive", "|"),
    "compiled-hertz": ("tab:green", "+"),
    "exudyn": ("tab:orange", "D"),
    "pymunk": ("tab:brown", "P"),
    "pybullet": ("tab:pink", "p"),
    "dart": ("goldenrod", "h"),
}
"""Colour and marker of each method."""


OUR_FACES = {"Euler": "crimson", "implicitfast": "mistyrose", "RK4": "white"}
"""Faces of our markers by integrator."""


def draw_charts(
    results: Results, folder: Path, errors: Mapping[str, str] = ERRORS
) -> tuple[Path, ...]:
    """Draws one picture per scene; returns their paths.

    Args:
        results: What to draw.
        folder: Where to write, must exist.
        errors: Names of the errors that are drawn, and their labels.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    paths = list[Path]()
    for scene in results.scenes:
        figure = _scene_figure(results, scene, errors)
        path = folder / f"{scene}.png"
        with replacing(path) as part:
            figure.savefig(part, dpi=110)
        paths.append(path)
    return tuple(paths)


def _scene_figure(results: Results, scene: str, errors: Mapping[str, str]) -> Figure:
    """Returns the figure of a scene: one panel for each error that is known."""
    points = results.of_scene(scene)
    drawn = [error for error in errors if any(drawable(p, error) for p in points)]
    panels = max(1, len(drawn))
    figure = new_figure(2.0 + 5.5 * panels, 6.6)
    axes: Any = figure.subplots(1, panels, squeeze=False)[0]
    for axis, error in zip(axes, drawn, strict=False):
        _draw_panel(axis, points, error, results.methods)
        axis.set_ylabel(errors[error])
    handles: dict[str, Any] = {}
    for axis in axes:
        lines, labels = axis.get_legend_handles_labels()
        handles |= dict(zip(labels, lines, strict=True))
    columns = 3 if panels > 1 else 2
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside lower center",
        ncols=columns,
        fontsize=9,
    )
    figure.suptitle(f"{scene}: {results.scenes[scene]}", fontsize=13)
    return figure


def new_figure(width: float, height: float) -> Figure:
    """Returns an empty figure of a size [inch].

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    require_matplotlib()
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _draw_panel(
    axis: Axes, points: Sequence[Point], error: str, titles: dict[str, str]
) -> None:
    """Draws all points of a scene, and the front."""
    for method, title in titles.items():
        mine = [p for p in points if p.method == method and drawable(p, error)]
        if mine:
            _draw_method(axis, mine, error, title)
    best = [point for point in front_of(points, error) if drawable(point, error)]
    axis.step(
        [point.cost for point in best],
        [shown(point, error) for point in best],
        where="post",
        color="grey",
        linewidth=2.5,
        alpha=0.4,
        zorder=1,
        label="Pareto front of the simulators",
    )
    axis.axvline(1.0, color="black", linewidth=0.6, linestyle=":", zorder=0)
    axis.set(
        xscale="log",
        yscale="log",
        xlabel="run time / run time of MuJoCo's defaults at 2 ms",
    )
    axis.grid(alpha=0.25, which="major")


def _draw_method(axis: Axes, points: Sequence[Point], error: str, title: str) -> None:
    """Draws the points of one method; ours by integrator, with their timesteps."""
    method = points[0].method
    colour, marker = STYLES[method]
    if method != OURS:
        _draw_points(axis, points, error, title, color=colour, marker=marker)
        return
    for integrator, face in OUR_FACES.items():
        mine = [point for point in points if point.integrator == integrator]
        if not mine:
            continue
        _draw_points(
            axis,
            mine,
            error,
            f"{title}, {integrator}",
            color=colour,
            marker=marker,
            markersize=9 if integrator == "implicitfast" else 13,
            markeredgecolor="white" if face == colour else colour,
            markerfacecolor=face,
            linestyle="-",
            linewidth=0.7,
            alpha=1.0,
            zorder=6 if face == colour else 5,
        )
        for point in mine if integrator == "Euler" else []:
            name_point(axis, point, error)


def _draw_points(
    axis: Axes, points: Sequence[Point], error: str, label: str, **style: Any
) -> None:
    """Draws markers with an entry in the legend."""
    thin = style["marker"] in "|+"
    usual: dict[str, Any] = {
        "linestyle": "none",
        "markersize": 7,
        "markeredgewidth": 2.0 if thin else 0.6,
        "markeredgecolor": style["color"] if thin else "white",
        "alpha": 0.8,
        "zorder": 3,
    }
    heights = [shown(point, error) for point in points]
    costs = [point.cost for point in points]
    axis.plot(costs, heights, label=label, **(usual | style))


def name_point(axis: Axes, point: Point, error: str, *, above: bool = False) -> None:
    """Writes the timestep next to one of our points: below left, or above right."""
    axis.annotate(
        f"{point.timestep * 1e3:g} ms",
        (point.cost, shown(point, error)),
        xytext=(7, 3) if above else (-7, -10),
        ha="left" if above else "right",
        textcoords="offset points",
        fontsize=8,
        color="crimson",
        zorder=7,
    )


def drawable(point: Point, error: str) -> bool:
    """Returns whether a point has a place in the chart."""
    return math.isfinite(point.cost) and math.isfinite(getattr(point, error))


def shown(point: Point, error: str) -> float:
    """Returns the height at which a point is drawn."""
    return min(max(float(getattr(point, error)), SMALLEST_ERROR), LARGEST_ERROR)
