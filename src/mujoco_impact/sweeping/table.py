"""The columns of a sweep, its rows, and what they look like as text."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import TypeAlias

from mujoco_impact.sweeping.parameters import Value, unit_of
from mujoco_impact.sweeping.quantities import (
    INTEGER,
    NUMBER,
    QUANTITIES,
    TEXT,
    Recorded,
    velocity_columns,
)
from mujoco_impact.sweeping.run_case import ERROR, REMARKS, Task
from mujoco_impact.sweeping.specification import Specification

Row: TypeAlias = dict[str, Recorded]
"""A cell for each column, by its name."""

CASE, REPEAT = "case", "repeat"
"""Columns that number the rows."""


@dataclasses.dataclass(frozen=True)
class Column:
    """A column of the rows of a sweep.

    Attributes:
        name: Its name.
        kind: `INTEGER`, `NUMBER` or `TEXT`.
        unit: Its unit, "" if it has none.
    """

    name: str
    kind: str
    unit: str = ""


def columns_of(spec: Specification) -> tuple[Column, ...]:
    """Returns the columns: the case, what was varied, what was recorded, remarks."""
    varied = [
        Column(name, _kind(spec, name), unit_of(name, spec.builder))
        for name in spec.varied
    ]
    recorded: list[Column] = []
    for name in spec.record:
        quantity = QUANTITIES[name.partition(".")[0]]
        names = [name]
        if name.startswith("velocity_after."):
            names = velocity_columns(name.partition(".")[2])
        recorded += [Column(one, quantity.kind, quantity.unit) for one in names]
    numbers = [Column(CASE, INTEGER), Column(REPEAT, INTEGER)]
    texts = [Column(REMARKS, TEXT), Column(ERROR, TEXT)]
    return (*numbers, *varied, *recorded, *texts)


def tasks_of(spec: Specification) -> Iterator[Task]:
    """Yields what there is to do, in the order of the rows."""
    for case in spec.cases:
        for _ in range(spec.repeats):
            yield Task(case, str(spec.folder), spec.record)


def beginnings(spec: Specification) -> Iterator[Row]:
    """Yields what is known of each row before it is run, in order."""
    kinds = {name: _kind(spec, name) for name in spec.varied}
    for number, case in enumerate(spec.cases):
        for repeat in range(spec.repeats):
            yield {
                CASE: number,
                REPEAT: repeat,
                **{name: _cell(case[name], kind) for name, kind in kinds.items()},
            }


def _kind(spec: Specification, name: str) -> str:
    """Returns the kind of the column of a parameter."""
    values = [case[name] for case in spec.cases]
    if any(isinstance(value, bool | str | list) for value in values):
        return TEXT
    whole = all(isinstance(value, int) for value in values)
    return INTEGER if whole else NUMBER


def _cell(value: Value, kind: str) -> Recorded:
    """Returns a value of a parameter as it stands in a column."""
    if kind == TEXT:
        return shown(value) or None
    return value  # type: ignore[return-value]


def shown(value: Value | Sequence[Value]) -> str:
    """Returns a value of a parameter as text."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return " ".join(map(shown, value))
    return value if isinstance(value, str) else repr(value)


def to_text(cell: Recorded) -> str:
    """Returns a cell as text, numbers with all their digits, "" if it is not known."""
    if cell is None:
        return ""
    return repr(float(cell)) if isinstance(cell, float) else str(cell)


def of_text(text: str, kind: str) -> Recorded:
    """Returns the cell of a text; ValueError if it is of another kind."""
    if not text:
        return None
    if kind == INTEGER:
        return int(text)
    return float(text) if kind == NUMBER else text
