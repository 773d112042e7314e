"""Picture of a sweep: what was varied against what was recorded.

A panel for each quantity (down) over each parameter (across). One line for each method,
or what else is not on the axis; dots where a parameter was drawn at random.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from mujoco_impact.comparison import OURS
from mujoco_impact.errors import SweepError
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.plot import panels
from mujoco_impact.plot.panels import literal
from mujoco_impact.sweeping.parameters import ITSELF
from mujoco_impact.sweeping.quantities import QUANTITIES, TEXT
from mujoco_impact.sweeping.table import Column, Row, shown
from mujoco_impact.text import closest
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from mujoco_impact.sweeping.sweep import Sweep

WIDE = 30.0
"""An axis is logarithmic if its largest number is more than so many smallest ones."""

MOST_LINES = 10
"""Lines that can be told apart; with more, what makes them differ is left to dots."""

COLOURS = (*panels.COLOURS, "tab:brown", "tab:pink", "tab:olive", "tab:cyan")
MARKERS = (*panels.MARKERS, "P", "X", "<", ">")
"""One for each line; the first ones as in pictures of comparisons."""

FEW_DECADES = 1e3
"""A logarithmic axis that is shorter has numbers at 2 and 5, too."""

Group: TypeAlias = tuple[Any, ...]
"""What the rows of a line have in common."""


def plot_sweep(sweep: Sweep, path: str | os.PathLike[str]) -> Path:
    """Draws a sweep into a file, see `Sweep.plot`."""
    require_matplotlib()
    target = Path(path)
    figure = _figure(sweep)
    with replacing(target) as part:
        figure.savefig(part, dpi=130, format=target.suffix[1:] or "png")
    return target


def _figure(sweep: Sweep) -> Figure:
    """Returns the picture."""
    from matplotlib.figure import Figure

    across, down = _axes_of(sweep)
    size = (2.2 + 5.6 * len(across), 1.6 + 3.6 * len(down))
    figure = Figure(figsize=size, layout="constrained")
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
    handles = {
        label: handle
        for axis in axes.flat
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)
    }
    if len(handles) > 1:
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=min(len(handles), max(2, round(size[0] / 2.6))),
            fontsize=9,
        )
    figure.suptitle(literal(_title(sweep)), fontsize=11)
    return figure


def _title(sweep: Sweep) -> str:
    """Returns the title: that of the specification, or the scene."""
    fixed = sweep.specification.fixed
    scene = str(fixed.get("scene.model", fixed.get("scene.builder", "")))
    title = str(sweep.specification.plot.get("title", Path(scene).stem))
    failed = len(sweep.failures)
    return f"{title} ({failed} of {len(sweep.rows)} failed)" if failed else title


def _axes_of(sweep: Sweep) -> tuple[list[Column], list[Column]]:
    """Returns the columns to draw across and down, those asked for or all numbers."""
    columns = {column.name: column for column in sweep.columns}
    spec = sweep.specification
    numbers = [
        column
        for column in sweep.columns
        if column.kind != TEXT and _values(sweep.rows, column.name)
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


def _values(rows: Sequence[Row], name: str) -> list[Any]:
    """Returns what is known of a column."""
    return [row[name] for row in rows if row[name] is not None]


def _label(column: Column) -> str:
    """Returns the label of an axis."""
    quantity, _, part = column.name.partition(".")
    words = column.name.replace("_", " ")
    if quantity in ("scene", "attach"):
        words = part.replace("_", " ")
    return literal(f"{words} [{column.unit}]" if column.unit else words)


def _draw(sweep: Sweep, axis: Axes, across: Column, down: Column) -> None:
    """Draws one quantity over one parameter."""
    names = _line_names(sweep, across)
    dots = _drawn_at_random(sweep, across) or not _all_told(sweep, across, names)
    groups: dict[Group, list[Row]] = {}
    for row in sweep.rows:
        groups.setdefault(tuple(row[name] for name in names), []).append(row)
    for number, (group, rows) in enumerate(groups.items()):
        places, values = _points(rows, across.name, down.name, median=not dots)
        axis.plot(
            places,
            values,
            label=literal(_told(names, group, groups)),
            color=COLOURS[number % len(COLOURS)],
            marker=MARKERS[number % len(MARKERS)],
            markersize=7 if OURS in group else 5,
            linewidth=2.4 if OURS in group else 1.2,
            linestyle="none" if dots else "-",
            alpha=0.6 if dots else 1.0,
        )
    for one, scale, column in (
        (axis.xaxis, axis.set_xscale, across),
        (axis.yaxis, axis.set_yscale, down),
    ):
        _set_scale(one, scale, _values(sweep.rows, column.name))
    axis.grid(alpha=0.25)


def _line_names(sweep: Sweep, across: Column) -> list[str]:
    """Returns the parameters that make a line: others than that of the axis.

    Those that follow from the rest, such as an angle from which a speed on the axis
    comes, are none.
    """
    spec = sweep.specification
    random = [name for name in spec.varied if f"{name}" in _random_names(sweep)]
    names = [name for name in spec.varied if name not in (across.name, *random)]
    if across.name not in spec.varied:
        # a recorded number is on the axis: numbers that were varied move along it
        texts = {column.name for column in sweep.columns if column.kind == TEXT}
        names = [name for name in names if name in texts]
    while names and len({tuple(row[n] for n in names) for row in sweep.rows}) > (
        MOST_LINES
    ):
        # the parameter of the most values makes the lines too many
        names.remove(max(names, key=lambda n: len(set(_values(sweep.rows, n)))))
    return names


def _random_names(sweep: Sweep) -> set[str]:
    """Returns the parameters that were drawn at random."""
    tables = sweep.specification.tables
    fixed = {*_flat(tables["grid"]), *_flat(tables["list"])}
    return {name for name in sweep.specification.varied if name not in fixed}


def _flat(table: Any) -> list[str]:
    """Returns the names of the parameters of a table."""
    from mujoco_impact.sweeping.parameters import flattened

    return list(flattened(table, ""))


def _drawn_at_random(sweep: Sweep, across: Column) -> bool:
    """Returns whether neighbours on the axis differ in something that was drawn."""
    random = _random_names(sweep)
    return bool(random) and (across.name not in random or len(random) > 1)


def _all_told(sweep: Sweep, across: Column, names: Sequence[str]) -> bool:
    """Returns whether all that was varied is on the axis or makes the lines."""
    if across.name not in sweep.specification.varied:
        return True
    return {*names, across.name} >= set(sweep.specification.varied)


def _points(
    rows: Sequence[Row], across: str, down: str, *, median: bool
) -> tuple[list[Any], Array]:
    """Returns what is known of two columns, in order along the axis.

    Args:
        rows: Rows of a line.
        across: Column along the axis.
        down: Column of the quantity.
        median: Whether repeats are one point, their median.
    """
    known = [
        (row[across], row[down])
        for row in rows
        if row[across] is not None and row[down] is not None
    ]
    if not median:
        return [place for place, _ in known], np.array([value for _, value in known])
    found: dict[Any, list[Any]] = {}
    for place, value in known:
        found.setdefault(place, []).append(value)
    # texts stand in the order of the cases
    places = list(found)
    if not any(isinstance(place, str) for place in places):
        places.sort()
    return places, np.array([float(np.median(found[place])) for place in places])


def _told(names: Sequence[str], group: Group, groups: Iterable[Group]) -> str:
    """Returns the name of a line, one of several."""
    parts = []
    for name, value in zip(names, group, strict=True):
        if name == "method":
            parts.append(str(value))
        elif name == "tuned_for":
            at = names.index(name)
            rest = group[:at] + group[at + 1 :]
            others = [one for one in groups if one[:at] + one[at + 1 :] == rest]
            speed = "each speed" if value == ITSELF else f"{value} m/s"
            # methods that are not tuned have one line
            parts += [f"tuned for {speed}"] if len(others) > 1 else []
        elif value is not None:
            number = f"{value:.4g}" if isinstance(value, float) else shown(value)
            parts.append(f"{name.partition('.')[2] or name} = {number}")
    return ", ".join(parts)


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
