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
import math
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mujoco_impact.calibration.shots import Array, Shots
from mujoco_impact.errors import ShotsError

_AXES = "xyz"
_HEADING = re.compile(r"^\s*(\w+)\s*(?:\[([^\]]*)\])?\s*$")
_MASS = re.compile(r"^m([1-9]\d*)$")


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
    with target.open("w", newline="", encoding="utf-8") as file:
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
        ShotsError: If the file is missing, or a column, unit or number is not what the
            format asks for; the message names line and column.
    """
    source = Path(path)
    try:
        with source.open(newline="", encoding="utf-8-sig") as file:
            lines = list(csv.reader(file, strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise ShotsError(f"cannot read shots from {source}: {reason}") from error
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
    found: dict[str, str | None] = {}
    for position, heading in enumerate(headings, start=1):
        match = _HEADING.match(heading)
        name = match.group(1) if match else heading
        if match is None or name in found:
            problem = "twice" if match else "not 'name [unit]'"
            raise ShotsError(
                f"{source}, line 1, column {position}: {heading!r} is {problem}"
            )
        found[name] = match.group(2)
    balls = max(
        (int(m.group(1)) for name in found if (m := _MASS.match(name))), default=0
    )
    if balls < 2:
        msg = f"{source}, line 1: columns 'm1 [kg]', 'm2 [kg]', ... for 2 or more balls"
        raise ShotsError(f"{msg} are needed; found {', '.join(map(repr, headings))}")
    units = columns(balls)
    for name, unit in units.items():
        if name not in found:
            msg = f"{source}, line 1: column '{name} [{unit}]' is missing"
            raise ShotsError(f"{msg} ({balls} balls)")
        if found[name] != unit:
            given = (
                f"the unit [{found[name]}]" if found[name] is not None else "no unit"
            )
            msg = f"{source}, line 1, column {name!r} has {given}; allowed: [{unit}]"
            raise ShotsError(msg)
    for name in found:
        if name not in units and name != "shot":
            msg = f"{source}, line 1: unknown column {name!r} ({balls} balls)"
            raise ShotsError(f"{msg}; known: shot, {', '.join(units)}")
    return list(found)


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
        msg = f"{source}, line {line}, column {name!r}: {cell!r} is not a finite number"
        raise ShotsError(msg)
    return value


def _shots(
    source: Path, names: Sequence[str], table: Array, lines: Sequence[int]
) -> Shots:
    """Returns the shots of a table; what is wrong with one is told by its line."""
    balls = sum(1 for name in names if _MASS.match(name))
    ordered = table[:, [names.index(name) for name in columns(balls)]]
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
