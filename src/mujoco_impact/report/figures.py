"""Plots of a report (needs bokeh)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from mujoco_impact.trajectory import Array

MOST_POINTS = 1500
"""Points of a curve at most: more than a page has pixels."""

COLOURS = ("#c41e3a", "#212529", "#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd", "#8c564b",
           "#e377c2", "#17becf", "#bcbd22")  # fmt: skip
"""One for each curve; ours is the first."""


def new_figure(title: str, x: str, y: str, **options: Any) -> Any:
    """Returns an empty plot.

    Args:
        title: Above it.
        x: Name of the horizontal axis, with its unit.
        y: Name of the vertical axis, with its unit.
        **options: What else bokeh's `figure` takes.
    """
    from bokeh.plotting import figure

    plot = figure(
        title=title,
        x_axis_label=x,
        y_axis_label=y,
        tools="pan,box_zoom,wheel_zoom,reset,save",
        active_drag="box_zoom",
        active_scroll=None,
        sizing_mode="stretch_width",
        **{"height": 320, **options},
    )
    plot.toolbar.logo = None
    plot.toolbar.autohide = True
    plot.grid.grid_line_color = "#e9ecef"
    plot.outline_line_color = None
    return plot


def add_curves(
    plot: Any,
    x: Array,
    curves: Mapping[str, Array],
    *,
    colours: Sequence[str] = COLOURS,
    wide: str = "",
) -> None:
    """Draws curves over the same values, with their names at the pointer.

    Args:
        plot: Where.
        x: Values of the horizontal axis, shape (n,).
        curves: Values of each curve by name, shape (n,).
        colours: One for each curve.
        wide: Name of the curve that stands out.
    """
    from bokeh.models import HoverTool

    lines = []
    every = max(1, -(-len(x) // MOST_POINTS))
    for number, (name, values) in enumerate(curves.items()):
        source = {"x": _single(x[::every]), "y": _single(values[::every])}
        line = plot.line(
            "x",
            "y",
            source=_source(source),
            name=name,
            legend_label=name,
            color=colours[number % len(colours)],
            line_width=2.5 if name == wide else 1.4,
        )
        lines.append(line)
    tips = [("", "$name"), (_axis(plot.xaxis), "@x{0.0000}"),
            (_axis(plot.yaxis), "@y{0.0000e+0}")]  # fmt: skip
    plot.add_tools(HoverTool(renderers=lines, tooltips=tips))
    _tidy_legend(plot)


def add_points(
    plot: Any, columns: Mapping[str, Sequence[Any]], *, name: str, colour: str
) -> None:
    """Draws points; all columns are shown at the pointer.

    Args:
        plot: Where.
        columns: Values by name; the first two are the axes.
        name: Name of the points.
        colour: Their colour.
    """
    from bokeh.models import HoverTool

    x, y, *_ = columns
    drawn = plot.scatter(
        x, y, source=_source(columns), size=8, color=colour, legend_label=name,
        name=name, alpha=0.85,
    )  # fmt: skip
    tips = [("", name), *((column, f"@{{{column}}}") for column in columns)]
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips))
    _tidy_legend(plot)


def add_ranges(
    plot: Any, names: Sequence[str], low: Sequence[float], high: Sequence[float],
    value: Sequence[float], tips: Mapping[str, Sequence[str]],
) -> None:  # fmt: skip
    """Draws a range for each name, with a mark at its value.

    Args:
        plot: Where; its vertical axis holds the names.
        names: One a row.
        low: Lower ends.
        high: Upper ends.
        value: The values.
        tips: What is shown at the pointer.
    """
    from bokeh.models import HoverTool

    source = _source({"n": names, "low": low, "high": high, "v": value, **tips})
    bars = plot.hbar(y="n", left="low", right="high", height=0.35, source=source,
                     color="#a5b4c4")  # fmt: skip
    marks = plot.scatter("v", "n", source=source, size=10, color=COLOURS[0])
    shown = [("", "@n"), *((name, f"@{{{name}}}") for name in tips)]
    plot.add_tools(HoverTool(renderers=[bars, marks], tooltips=shown))


def bars(
    title: str,
    x: str,
    names: Sequence[str],
    values: Sequence[float],
    *,
    colours: Sequence[str],
) -> Any:
    """Returns a plot of one horizontal bar for each name."""
    from bokeh.models import HoverTool

    plot = new_figure(
        title, x, "", y_range=list(reversed(names)), height=90 + 34 * len(names)
    )
    source = _source({"n": names, "v": values, "c": colours})
    drawn = plot.hbar(y="n", right="v", height=0.6, color="c", source=source)
    plot.x_range.start = min(0.0, *values)
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=[("", "@n"), (x, "@v")]))
    return plot


def grid(plots: Sequence[Any], *, columns: int) -> Any:
    """Returns plots side by side, with one set of tools."""
    from bokeh.layouts import gridplot

    layout = gridplot(
        list(plots), ncols=columns, sizing_mode="stretch_width", merge_tools=True
    )
    layout.toolbar.logo = None
    return layout


def _source(columns: Mapping[str, Any]) -> Any:
    """Returns columns as bokeh takes them."""
    from bokeh.models import ColumnDataSource

    return ColumnDataSource(dict(columns))


def _single(values: Array) -> npt.NDArray[np.float32]:
    """Returns values in half the bytes: the page holds them as text."""
    return np.asarray(values, dtype=np.float32)


def _axis(axis: Any) -> str:
    """Returns the name of an axis."""
    return str(axis[0].axis_label)


def put_legend_inside(plot: Any) -> None:
    """Puts the legend into the plot, which then is as wide as its neighbours."""
    legend = plot.legend[0]
    plot.right.remove(legend)
    plot.add_layout(legend, "center")
    legend.location = "bottom_right"


def _tidy_legend(plot: Any) -> None:
    """Puts the legend beside the plot; a click hides a curve."""
    legend = plot.legend[0]
    legend.click_policy = "hide"
    legend.label_text_font_size = "11px"
    legend.spacing = 0
    legend.padding = 4
    legend.background_fill_alpha = 0.6
    if legend not in plot.right:
        plot.add_layout(legend, "right")
