"""Which rows of a sweep make one line of a picture, and what it is called."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from mujoco_impact.comparison import OURS
from mujoco_impact.sweeping.parameters import ITSELF
from mujoco_impact.sweeping.quantities import TEXT
from mujoco_impact.sweeping.table import Row, shown
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from mujoco_impact.sweeping.sweep import Sweep

MOST_LINES = 12
"""Lines that can be told apart. With more, what makes them differ is left to dots."""

Group: TypeAlias = tuple[Any, ...]
"""What the rows of a line have in common."""


@dataclasses.dataclass(frozen=True)
class Line:
    """A line of a picture, or dots of one kind.

    Attributes:
        label: Its name; "" if there is no other.
        colour: Number of its method, or of what else is no number: the same in all
            panels.
        style: Number of its numbers.
        ours: Whether the impacts are ours.
        joined: Whether its points are joined.
        places: Where its points are along the axis.
        values: What was recorded there, the median of repeats.
    """

    label: str
    colour: int
    style: int
    ours: bool
    joined: bool
    places: list[Any]
    values: Array


def lines_of(sweep: Sweep, across: str, down: str) -> list[Line]:
    """Returns the lines of a panel.

    Args:
        sweep: The sweep.
        across: Column along the axis.
        down: Column that was recorded.
    """
    names = _line_names(sweep, across)
    texts = {column.name for column in sweep.columns if column.kind == TEXT}
    kinds = [name for name in names if name in texts]
    numbers = [name for name in names if name not in texts]
    groups: dict[Group, list[Row]] = {}
    for row in sweep.rows:
        groups.setdefault(_group(row, names), []).append(row)
    colours = _numbered(sweep.rows, kinds or numbers)
    styles = _numbered(sweep.rows, numbers if kinds else [])
    joined = _is_joined(sweep, across, names)
    lines = []
    for group, rows in groups.items():
        places, values = _points(rows, across, down, median=joined)
        line = Line(
            label=_told(names, group, list(groups)),
            colour=colours[_group(rows[0], kinds or numbers)],
            style=styles[_group(rows[0], numbers if kinds else [])],
            ours=OURS in group,
            joined=joined,
            places=places,
            values=values,
        )
        lines.append(line)
    return lines


def values_of(rows: Sequence[Row], name: str) -> list[Any]:
    """Returns what is known of a column."""
    return [row[name] for row in rows if row[name] is not None]


def _group(row: Row, names: Sequence[str]) -> Group:
    """Returns what a row has in some columns."""
    return tuple(row[name] for name in names)


def _numbered(rows: Sequence[Row], names: Sequence[str]) -> Mapping[Group, int]:
    """Returns a number for all that rows have in some columns, in order."""
    found = dict.fromkeys(_group(row, names) for row in rows)
    return {group: number for number, group in enumerate(found)}


def _line_names(sweep: Sweep, across: str) -> list[str]:
    """Returns the parameters that make a line.

    Those that were drawn do not, nor, beside a recorded number, others: they move along
    it. Nor do those of the most values, if there were too many lines.
    """
    drawn = sweep.specification.tables["random"]
    names = [name for name in _varied(sweep) if name not in (across, *drawn)]
    if across not in _varied(sweep):
        texts = {column.name for column in sweep.columns if column.kind == TEXT}
        names = [name for name in names if name in texts]
    while len(_numbered(sweep.rows, names)) > MOST_LINES:
        names.remove(max(names, key=lambda name: len(_numbered(sweep.rows, [name]))))
    return names


def _varied(sweep: Sweep) -> tuple[str, ...]:
    """Returns the parameters of more than one value."""
    return tuple(
        name
        for name in sweep.specification.varied
        if len(_numbered(sweep.rows, [name])) > 1
    )


def _is_joined(sweep: Sweep, across: str, names: Sequence[str]) -> bool:
    """Returns whether all that was varied is along the axis, or makes the lines."""
    left = [name for name in _varied(sweep) if name not in (across, *names)]
    # along a recorded number moves the one parameter that it comes from
    return len(left) <= (across not in _varied(sweep))


def _points(
    rows: Sequence[Row], across: str, down: str, *, median: bool
) -> tuple[list[Any], Array]:
    """Returns what is known of two columns, in order along the axis.

    Args:
        rows: Rows of a line.
        across: Column along the axis.
        down: Column that was recorded.
        median: Whether what stands at one place is one point.
    """
    found: dict[Any, list[Any]] = {}
    for row in rows:
        if row[across] is not None and row[down] is not None:
            found.setdefault(row[across], []).append(row[down])
    # texts stay in the order of the cases
    places = list(found)
    if not any(isinstance(place, str) for place in places):
        places.sort()
    if median:
        return places, np.array([float(np.median(found[place])) for place in places])
    pairs = [(place, value) for place in places for value in found[place]]
    return [place for place, _ in pairs], np.array([value for _, value in pairs])


def _told(names: Sequence[str], group: Group, groups: Sequence[Group]) -> str:
    """Returns the name of a line, one of several."""
    parts: dict[str, str] = {}
    for at, (name, value) in enumerate(zip(names, group, strict=True)):
        if name == "method":
            parts[name] = str(value)
        elif name == "tuned_for":
            rest = group[:at] + group[at + 1 :]
            others = [one for one in groups if one[:at] + one[at + 1 :] == rest]
            speed = "each speed" if value == ITSELF else f"{value} m/s"
            # methods that are not tuned have one line
            if len(others) > 1:
                parts[name] = f"tuned for {speed}"
        elif value is not None:
            number = f"{value:.4g}" if isinstance(value, float) else shown(value)
            parts[name] = f"{name.removeprefix('scene.').removeprefix('attach.')} = "
            parts[name] += number
    first = parts.pop("method", None)
    return ", ".join([*([first] if first else []), *parts.values()])
