"""The outcome of the benchmark, and its files."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from mujoco_impact.errors import ImpactError
from mujoco_impact.files import write_text
from mujoco_impact_lab.bench.impacts import ImpactTimes, WaveTimes
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.steps import StepTimes
from mujoco_impact_lab.bench.summary import summarize

LAYOUT_VERSION = 2
"""Version of the layout of the JSON file."""

CSV_NAME, JSON_NAME = "results.csv", "results.json"

DIGITS = 6
"""Significant digits in the files; measurements have fewer."""


class ResultsError(ImpactError):
    """A file of results is missing, damaged or of another layout."""


@dataclasses.dataclass(frozen=True)
class Results:
    """The outcome of a run of the benchmark.

    Attributes:
        scenes: Title of each scene by name.
        methods: Title of each method by name.
        points: All points.
        steps: Times of single steps.
        impacts: Times of single impacts, the law alone.
        waves: Times of impacts that travel through long rows, the law alone.
        missing: Why a method was not measured, by its name, or that of the method and
            the scene.
        versions: Version of everything that was measured, by name.
        machine: The machine.
        quick: Whether only a part was measured.
    """

    scenes: dict[str, str]
    methods: dict[str, str]
    points: tuple[Point, ...]
    steps: tuple[StepTimes, ...]
    impacts: tuple[ImpactTimes, ...]
    waves: tuple[WaveTimes, ...]
    missing: dict[str, str]
    versions: dict[str, str]
    machine: dict[str, str | int]
    quick: bool

    def of_scene(self, scene: str) -> list[Point]:
        """Returns the points of a scene."""
        return [point for point in self.points if point.scene == scene]

    def to_dict(self) -> dict[str, Any]:
        """Returns plain numbers and text, with a summary; None stands for nan."""
        document = dataclasses.asdict(self)
        for table in _TABLES:
            document[table] = list(map(_plain_row, document[table]))
        # of the rounded points, so that it follows from the file
        summaries = summarize(tuple(map(_point, document["points"])))
        document["summary"] = [_plain_row(dataclasses.asdict(row)) for row in summaries]
        return {"layout_version": LAYOUT_VERSION, **document}

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Results:
        """Returns the results that `to_dict` wrote.

        Raises:
            ResultsError: If the document has another layout.
        """
        fields = dict(document) if isinstance(document, dict) else {}
        version = fields.pop("layout_version", None)
        if version != LAYOUT_VERSION:
            msg = f"layout version {version}, this package reads {LAYOUT_VERSION}"
            raise ResultsError(msg)
        try:
            # it follows from the points
            del fields["summary"]
            for table, of_row in _TABLES.items():
                fields[table] = tuple(of_row(row) for row in fields[table])
            return cls(**fields)
        except (KeyError, TypeError) as error:
            raise ResultsError(f"these are not results: {error}") from error


def write_results(results: Results, folder: Path) -> tuple[Path, Path]:
    """Writes the CSV and the JSON file; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    table, document = folder / CSV_NAME, folder / JSON_NAME
    write_text(table, points_to_csv(results.points))
    text = json.dumps(results.to_dict(), indent=1, allow_nan=False)
    write_text(document, text + "\n")
    return table, document


def read_results(path: Path) -> Results:
    """Reads a JSON file of results.

    Raises:
        ResultsError: If it is missing, damaged or of another layout.
    """
    try:
        return Results.from_dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise ResultsError(f"cannot read results from {path}: {error}") from error


def points_to_csv(points: Sequence[Point]) -> str:
    """Returns a table with one line per point; unknown numbers are empty."""
    file = io.StringIO()
    names = [field.name for field in dataclasses.fields(Point)]
    writer = csv.DictWriter(file, names, lineterminator="\n")
    writer.writeheader()
    for point in points:
        writer.writerow(_plain_row(dataclasses.asdict(point)))
    return file.getvalue()


def points_from_csv(text: str) -> tuple[Point, ...]:
    """Returns the points of a table that `points_to_csv` wrote."""
    return tuple(_point(row) for row in csv.DictReader(io.StringIO(text)))


def _plain_row(row: dict[str, Any]) -> dict[str, Any]:
    return {key: _plain(value) for key, value in row.items()}


def _plain(value: Any) -> Any:
    """Returns a number rounded, None for nan, as JSON has it; the rest as it is."""
    if isinstance(value, tuple):
        return list(value)
    if not isinstance(value, float):
        return value
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None


def _point(row: dict[str, Any]) -> Point:
    """Returns a point of plain values, or of the text of them."""
    values = dict(row)
    for field in dataclasses.fields(Point):
        value = values[field.name]
        if field.type == "float":
            values[field.name] = math.nan if value in (None, "") else float(value)
        elif field.type == "bool":
            values[field.name] = value in (True, "True")
    return Point(**values)


_TABLES: dict[str, Callable[[dict[str, Any]], Any]] = {
    "points": _point,
    "steps": lambda row: StepTimes(**row),
    "impacts": lambda row: ImpactTimes(**row),
    "waves": lambda row: WaveTimes(**row),
}
"""The tables of the document, and how a row of them is read."""
