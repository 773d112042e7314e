"""One picture of everything, of the page on accuracy: four scenes, few methods."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mujoco_impact.files import replacing
from mujoco_impact_lab.bench.charts import (
    STYLES,
    drawable,
    name_point,
    new_figure,
    shown,
)
from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OVERVIEW_NAME = "overview.png"

SCENES = ("S1", "S2", "S4", "e09")
"""What is drawn: short rows, unequal balls, and a loss of energy."""

ERROR = "velocity_error"

WIDTH, HEIGHT, DOTS_PER_INCH = 9.0, 7.8, 100
"""Size of the picture [inch]: 900 pixels wide, as pages show it."""

COLUMNS = 2

TUNED = ("mujoco-elastic", "mujoco-damper", "mujoco-compliant", "mujoco-hertz")
"""Methods that share a colour: MuJoCo's contacts with anything set."""

LABELS = {
    OURS: "mujoco-impact (Euler)",
    DEFAULT: "MuJoCo, defaults",
    **dict.fromkeys(TUNED, "MuJoCo, tuned solref and solimp"),
    "exudyn": "Exudyn",
    "pymunk": "Pymunk",
    "pybullet": "PyBullet",
    "dart": "DART",
    "compiled-hertz": "equations alone, no engine",
}
"""Kind of each method that is drawn, for the legend."""


def draw_overview(results: Results, folder: Path) -> tuple[Path, ...]:
    """Draws the picture; returns its path, or nothing if it would be empty.

    Args:
        results: What to draw.
        folder: Where to write, must exist.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    scenes = [scene for scene in SCENES if scene in results.scenes]
    if not scenes:
        return ()
    lines = -(-len(scenes) // COLUMNS)
    figure = new_figure(WIDTH, 0.6 + (HEIGHT - 0.6) * lines / 2)
    axes: Any = figure.subplots(
        lines, min(COLUMNS, len(scenes)), sharex=True, sharey=True, squeeze=False
    )
    handles: dict[str, Any] = {}
    for scene, axis in zip(scenes, axes.flat, strict=False):
        _draw_scene(axis, results.of_scene(scene))
        axis.set_title(results.scenes[scene], fontsize=11)
        handles |= dict(zip(*reversed(axis.get_legend_handles_labels()), strict=True))
    for axis in axes.flat[len(scenes) :]:
        axis.set_axis_off()
    for axis in axes[-1]:
        axis.set_xlabel("run time / run time of MuJoCo's defaults")
    for axis in axes[:, 0]:
        axis.set_ylabel("velocity error after the first impact [v0]")
    figure.legend(
        handles.values(), handles.keys(), loc="outside lower center", ncols=4,
        fontsize=9, frameon=False,
    )  # fmt: skip
    path = folder / OVERVIEW_NAME
    with replacing(path) as part:
        figure.savefig(part, dpi=DOTS_PER_INCH)
    return (path,)


def _draw_scene(axis: Axes, points: Sequence[Point]) -> None:
    """Draws the methods in the order of the legend, ours on top."""
    kinds = dict.fromkeys(LABELS.values())
    for kind in kinds:
        mine = [
            point
            for point in points
            if LABELS.get(point.method) == kind
            and drawable(point, ERROR)
            and (point.method != OURS or point.integrator == "Euler")
        ]
        if mine:
            _draw_kind(axis, mine, kind)
    axis.axvline(1.0, color="black", linewidth=0.6, linestyle=":", zorder=0)
    axis.set(xscale="log", yscale="log")
    axis.grid(alpha=0.25, which="major")


def _draw_kind(axis: Axes, points: Sequence[Point], kind: str) -> None:
    """Draws the points of one kind of method; ours with their timesteps."""
    method = points[0].method
    ours, bound = method == OURS, not points[0].comparable
    colour, marker = ("tab:blue", "v") if method in TUNED else STYLES[method]
    line = "-" if ours else "--" if bound else "none"
    axis.plot(
        [point.cost for point in points],
        [shown(point, ERROR) for point in points],
        label=kind,
        color=colour,
        marker=marker,
        markersize=12 if ours else 7,
        markeredgecolor=colour if bound else "white",
        markeredgewidth=1.6 if bound else 0.4,
        linestyle=line,
        linewidth=0.8,
        zorder=6 if ours else 4 if method == DEFAULT else 3,
    )
    for point in points if ours else ():
        name_point(axis, point, ERROR, above=True)
