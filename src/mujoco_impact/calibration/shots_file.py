"""Shots as CSV: one row per shot, the unit of every column in its heading.

For n balls, i from 1 to n, and contacts k from 1 to n - 1, in any order of columns:

    shot                                             any label
    m<i> [kg]                                        the same in every row
    v<i>x_before [m/s], v<i>y_before [m/s], v<i>z_before [m/s]
    v<i>x_after [m/s], v<i>y_after [m/s], v<i>z_after [m/s]
    n<k>x [-], n<k>y [-], n<k>z [-]                  unit vector, ball k to ball k + 1
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mujoco_impact.calibration.shots import MOST_BALLS, Array, Shots
from mujoco_impact.errors import ShotsError
from mujoco_impact.files import quoted, read_text, replacing

_AXES = "xyz"
_HEADING = re.compile(r"^\s*(\w+)\s*(?:\[([^\]]*)\])?\s*$")
_MASS = re.compile(r"^m[1-9][0-9]*$")

_MOST_SHOWN = 10
"""Most headings that a message lists."""


def columns(balls: int) -> dict[str, str]:
    """Returns the unit of every column of numbers, by name, for a row of balls."""
    units = {f"m{i}": "kg" for i in range(1, balls + 1)}
    for when in ("before", "after"):
        for i in range(1, balls + 1):
            units |= {f"v{i}{axis}_{when}": "m/s" for axis in _AXES}
    for k in range(1, balls):
        units |= {f"n{k}{axis}": "-" for axis in _AXES}
    return units


def write_shots(shots: Shots, path: str | os.PathLike[str]) -> Path:
    """Writes shots as CSV, every number with all its digits.

    Args:
        shots: What to write.
        path: File to write.

    Returns:
        The path written.
    """
    units = columns(len(shots.masses))
    target = Path(path)
    masses = np.broadcast_to(shots.masses, (shots.count, len(shots.masses)))
    blocks = [masses, shots.before, shots.after, shots.directions]
    numbers = np.hstack([block.reshape(shots.count, -1) for block in blocks])
    with (
        replacing(target) as part,
        part.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(["shot", *(f"{name} [{unit}]" for name, unit in units.items())])
        for shot, row in enumerate(numbers.tolist(), start=1):
            writer.writerow([shot, *map(repr, row)])
    return target


def read_shots(path: str | os.PathLike[str]) -> Shots:
    """Reads shots from a CSV file in the format above.

    Args:
        path: File to read.

    Returns:
        The shots.

    Raises:
        ShotsError: If the file is missing, larger than `files.LARGEST_TEXT` or of more
            than `MOST_BALLS` balls, or a column, unit or number is not what the
            format asks for; the message names line and column.
    """
    source = Path(path)
    text = read_text(source, what="shots", error=ShotsError)
    try:
        lines = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except csv.Error as error:
        raise ShotsError(f"cannot read shots from {source}: {error}") from error
    if not lines or not any(cell.strip() for cell in lines[0]):
        raise ShotsError(
            f"{source} is empty; line 1 must be headings such as 'm1 [kg]'"
        )
    names = _checked_headings(source, lines[0])
    rows = [(number, row) for number, row in enumerate(lines[1:], start=2) if row]
    if not rows:
        raise ShotsError(f"{source} has no shots; one row per shot is needed")
    table = np.array([_numbers(source, number, names, row) for number, row in rows])
    return _shots(source, names, table, [number for number, _ in rows])


def _checked_headings(source: Path, headings: Sequence[str]) -> list[str]:
    """Returns the names of the columns; ShotsError if one is wrong or missing."""
    most = 1 + len(columns(MOST_BALLS))
    if len(headings) > most:
        msg = f"{source}, line 1: {len(headings)} columns, the first {_list(headings)}"
        raise ShotsError(f"{msg}; allowed: {most}, for {MOST_BALLS} balls")
    found: dict[str, str | None] = {}
    for position, heading in enumerate(headings, start=1):
        match = _HEADING.match(heading)
        name = match.group(1) if match else heading
        if match is None or name in found:
            problem = "twice" if match else "not 'name [unit]'"
            raise ShotsError(
                f"{source}, line 1, column {position}: {quoted(heading)} is {problem}"
            )
        found[name] = match.group(2)
    # as many balls as masses: a number in a heading may claim any number of them
    balls = sum(1 for name in found if _MASS.match(name))
    if not 2 <= balls <= MOST_BALLS:
        msg = f"{source}, line 1: columns 'm1 [kg]', 'm2 [kg]', ... for 2 to "
        raise ShotsError(f"{msg}{MOST_BALLS} balls are needed; found {_list(headings)}")
    units = columns(balls)
    for name, unit in units.items():
        if name not in found:
            msg = f"{source}, line 1: column '{name} [{unit}]' is missing"
            raise ShotsError(f"{msg} ({balls} balls)")
        if found[name] != unit:
            unit_found = found[name]
            given = "no unit" if unit_found is None else f"the unit [{unit_found[:20]}]"
            msg = f"{source}, line 1, column {name!r} has {given}; allowed: [{unit}]"
            raise ShotsError(msg)
    for name in found:
        if name not in units and name != "shot":
            msg = f"{source}, line 1: unknown column {quoted(name)} "
            raise ShotsError(f"{msg}({balls} balls); known: {_list(['shot', *units])}")
    return list(found)


def _list(headings: Sequence[str]) -> str:
    """Returns headings for a message, not all if there are many."""
    shown = ", ".join(map(quoted, headings[:_MOST_SHOWN]))
    hidden = len(headings) - _MOST_SHOWN
    return f"{shown} and {hidden} more" if hidden > 0 else shown


def _numbers(
    source: Path, line: int, names: Sequence[str], row: Sequence[str]
) -> list[float]:
    """Returns the numbers of one row; NaN for the label of the shot."""
    if len(row) != len(names):
        msg = f"{source}, line {line}: {len(row)} cells; the headings have {len(names)}"
        raise ShotsError(msg)
    return [
        math.nan if name == "shot" else _number(source, line, name, cell)
        for name, cell in zip(names, row, strict=True)
    ]


def _number(source: Path, line: int, name: str, cell: str) -> float:
    """Returns the number of one cell."""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        msg = f"{source}, line {line}, column {name!r}: {quoted(cell)}"
        raise ShotsError(f"{msg} is not a finite number")
    return value


def _shots(
    source: Path, names: Sequence[str], table: Array, lines: Sequence[int]
) -> Shots:
    """Returns the shots of a table; what is wrong with one is told by its line."""
    balls = sum(1 for name in names if _MASS.match(name))
    position = {name: index for index, name in enumerate(names)}
    ordered = table[:, [position[name] for name in columns(balls)]]
    masses, before, after, directions = np.split(
        ordered, [balls, 4 * balls, 7 * balls], axis=1
    )
    differs = np.argwhere(masses != masses[0])
    if len(differs):
        row, ball = differs[0]
        msg = (
            f"{source}, line {lines[row]}, column 'm{ball + 1}': "
            f"{masses[row, ball]} kg, but {masses[0, ball]} kg in line {lines[0]}; "
            "a file holds one row of balls"
        )
        raise ShotsError(msg)
    count = len(table)
    try:
        return Shots(
            masses[0],
            before.reshape(count, balls, 3),
            after.reshape(count, balls, 3),
            directions.reshape(count, balls - 1, 3),
        )
    except ShotsError as error:
        # rows are counted as shots there, as lines here
        shot = re.match(r"shot (\d+)", str(error))
        where = f", line {lines[int(shot.group(1)) - 1]}" if shot else ""
        raise ShotsError(f"{source}{where}: {error}") from error
