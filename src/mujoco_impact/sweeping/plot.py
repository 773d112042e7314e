"""Picture of a sweep: what was varied against what was recorded.

A panel for each quantity (down) over each parameter (across). One line for each method,
or what else is not on the axis; dots where more than that was varied.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mujoco_impact.errors import SweepError
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.plot import panels
from mujoco_impact.plot.panels import literal
from mujoco_impact.sweeping.lines import lines_of, values_of
from mujoco_impact.sweeping.quantities import QUANTITIES, TEXT
from mujoco_impact.sweeping.table import Column, shown
from mujoco_impact.text import closest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from mujoco_impact.sweeping.sweep import Sweep

WIDE = 30.0
"""An axis is logarithmic if its largest number is more than so many smallest ones."""

FEW_DECADES = 1e3
"""A logarithmic axis that is shorter has numbers at 2 and 5, too."""

COLOURS = (*panels.COLOURS, "tab:brown", "tab:pink", "tab:olive", "tab:cyan")
MARKERS = (*panels.MARKERS, "P", "X", "<", ">")
"""One for each method; the first ones as in pictures of comparisons."""

STYLES = ("-", "--", ":", "-.")
"""One for each set of numbers of lines of one colour."""

LETTER_WIDTH, LINE_WIDTH = 0.085, 0.7
"""Width of a letter of a legend, and of the line beside a label [inch]."""


def plot_sweep(sweep: Sweep, path: str | os.PathLike[str]) -> Path:
    """Draws a sweep into a file, see `Sweep.plot`."""
    require_matplotlib()
    target = Path(path)
    figure = sweep_figure(sweep)
    with replacing(target) as part:
        figure.savefig(part, dpi=130, format=target.suffix[1:] or "png")
    return target


def sweep_figure(sweep: Sweep) -> Figure:
    """Returns the picture; SweepError if there is nothing to draw."""
    from matplotlib.figure import Figure

    across, down = _axes_of(sweep)
    width = 2.2 + 5.6 * len(across)
    figure = Figure(figsize=(width, 1.6 + 3.6 * len(down)), layout="constrained")
    axes = figure.subplots(
        len(down), len(across), sharex="col", sharey="row", squeeze=False
    )
    for row, quantity in zip(axes, down, strict=True):
        for axis, parameter in zip(row, across, strict=True):
            _draw(sweep, axis, parameter, quantity)
    for axis, parameter in zip(axes[-1], across, strict=True):
        axis.set_xlabel(_label(parameter))
    for axis, quantity in zip(axes[:, 0], down, strict=True):
        axis.set_ylabel(_label(quantity))
    _add_legends(figure, axes[-1], width)
    figure.suptitle(literal(_title(sweep)), fontsize=11)
    return figure


def _add_legends(figure: Figure, lowest: Sequence[Axes], width: float) -> None:
    """Adds one legend, or one for each column if their lines differ."""
    found = [axis.get_legend_handles_labels() for axis in lowest]
    labels = {tuple(names) for _, names in found}
    if len(labels) == 1:
        handles, names = found[0]
        if len(names) > 1:
            each = LINE_WIDTH + LETTER_WIDTH * max(map(len, names))
            columns = min(len(names), max(1, int(width / each)))
            figure.legend(
                handles,
                names,
                loc="outside lower center",
                ncols=columns,
                fontsize=9,
            )
        return
    for axis, (handles, names) in zip(lowest, found, strict=True):
        axis.legend(
            handles,
            names,
            loc="upper center",
            bbox_to_anchor=(0.5, -0.16),
            ncols=2,
            fontsize=9,
        )


def _title(sweep: Sweep) -> str:
    """Returns the title: that of the specification, or the scene."""
    fixed = sweep.specification.fixed
    scene = Path(str(fixed.get("scene.model", ""))).stem
    if "scene.builder" in fixed:
        given = [
            f"{name.partition('.')[2]} = {shown(value)}"
            for name, value in fixed.items()
            if name.startswith("scene.") and name != "scene.builder"
        ]
        scene = f"{fixed['scene.builder']} ({', '.join(given)})"
    title = str(sweep.specification.plot.get("title", scene))
    failed = len(sweep.failures)
    return f"{title} ({failed} of {len(sweep.rows)} failed)" if failed else title


def _axes_of(sweep: Sweep) -> tuple[list[Column], list[Column]]:
    """Returns the columns to draw across and down, those asked for or all numbers."""
    columns = {column.name: column for column in sweep.columns}
    spec = sweep.specification
    numbers = [
        column
        for column in sweep.columns
        if column.kind != TEXT and values_of(sweep.rows, column.name)
    ]
    varied = [one for one in numbers if one.name in spec.varied]
    recorded = [one for one in numbers if one.name.partition(".")[0] in QUANTITIES]
    across = _asked(sweep, "x", columns) or varied
    # nothing but texts was varied: they stand along the axis
    across = across or [columns[name] for name in spec.varied[:1]]
    names = {column.name for column in across}
    down = _asked(sweep, "y", columns) or [
        one for one in recorded if one.name not in names
    ]
    if not across or not down:
        missing = "varied" if not across else "recorded"
        raise SweepError(f"there is nothing to draw: no number was {missing}")
    return across, down


def _asked(sweep: Sweep, key: str, columns: dict[str, Column]) -> list[Column]:
    """Returns the columns that the specification asks for; SweepError if not there."""
    asked = sweep.specification.plot.get(key, [])
    names = [asked] if isinstance(asked, str) else asked
    for name in names:
        if name not in columns:
            raise SweepError(f"plot.{key}: no column {name!r}{closest(name, columns)}")
    return [columns[name] for name in names]


def _label(column: Column) -> str:
    """Returns the label of an axis."""
    kind, _, part = column.name.partition(".")
    words = column.name.replace("_", " ")
    if kind in ("scene", "attach"):
        words = part.replace("_", " ")
    elif kind == "velocity_after":
        body, _, axis = part.rpartition(".")
        words = f"{axis} velocity of {body} after"
    elif part:
        words = f"{kind} of {part.replace('+', ' and ')}"
    return literal(f"{words} [{column.unit}]" if column.unit else words)


def _draw(sweep: Sweep, axis: Axes, across: Column, down: Column) -> None:
    """Draws one quantity over one parameter."""
    for line in lines_of(sweep, across.name, down.name):
        axis.plot(
            line.places,
            line.values,
            label=literal(line.label),
            color=COLOURS[line.colour % len(COLOURS)],
            marker=MARKERS[line.colour % len(MARKERS)],
            markersize=7 if line.ours else 5,
            linewidth=2.2 if line.ours else 1.2,
            linestyle=STYLES[line.style % len(STYLES)] if line.joined else "none",
            alpha=1.0 if line.joined else 0.6,
            zorder=5 if line.ours else 3,
        )
    for one, scale, column in (
        (axis.xaxis, axis.set_xscale, across),
        (axis.yaxis, axis.set_yscale, down),
    ):
        _set_scale(one, scale, values_of(sweep.rows, column.name))
    axis.grid(alpha=0.25)


def _set_scale(axis: Axis, scale: Callable[[str], None], values: Sequence[Any]) -> None:
    """Makes an axis logarithmic if its numbers want that."""
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    if not values or isinstance(values[0], str) or min(values) <= 0:
        return
    spread = max(values) / min(values)
    if spread <= WIDE:
        return
    scale("log")
    if spread < FEW_DECADES:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(ScalarFormatter())
        axis.set_minor_formatter(NullFormatter())
