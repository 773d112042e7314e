"""Results are the same after they were written and read."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from mujoco_impact_lab.bench.impacts import ImpactTimes, WaveTimes
from mujoco_impact_lab.bench.machine import machine
from mujoco_impact_lab.bench.output import show
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import (
    Results,
    ResultsError,
    points_from_csv,
    points_to_csv,
    read_results,
    write_results,
)
from mujoco_impact_lab.bench.steps import StepTimes

# six digits are kept, so numbers of six digits come back as they were
NUMBERS = st.one_of(
    st.just(math.nan),
    st.integers(-999_999, 999_999)
    .map(lambda n: n * 1e-7)
    .map(lambda x: float(f"{x:.6g}")),
)
TEXT = st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=12)
POINTS = st.builds(
    Point,
    scene=TEXT,
    method=TEXT,
    setting=TEXT,
    integrator=TEXT,
    timestep=NUMBERS,
    cost=NUMBERS,
    run_time=NUMBERS,
    velocity_error=NUMBERS,
    angle_rms=NUMBERS,
    energy_drift=NUMBERS,
    comparable=st.booleans(),
    failure=TEXT,
)


def same(one: Point, other: Point) -> bool:
    """Equal, nan included."""
    pairs = zip(dataclasses.astuple(one), dataclasses.astuple(other), strict=True)
    return all(a == b or (a != a and b != b) for a, b in pairs)


def results(points: tuple[Point, ...]) -> Results:
    return Results(
        scenes={"S1": "three balls"},
        methods={"ours": "ours"},
        points=points,
        steps=(
            StepTimes("3 balls", 3, 10, 1.0, 1.0, 2.0, 3.0, 9.0, 0.5, 2.0, 0.4, 0.2),
        ),
        impacts=(ImpactTimes(3, 1e-5, 40, 1e-6, 5.0, 4.0, 50, 1e-4, 2.0, 2.5),),
        waves=(WaveTimes(100, 1000, 400.0, 4.0, 1.0),),
        missing={"dart": "not installed"},
        versions={"mujoco": "3"},
        machine={"cores": 2},
        quick=True,
    )


@settings(max_examples=30)
@given(st.lists(POINTS, max_size=5))
def test_points_survive_csv(points: list[Point]) -> None:
    """Commas, quotes and unknown numbers included."""
    read = points_from_csv(points_to_csv(points))
    assert len(read) == len(points)
    assert all(map(same, read, points))


@settings(max_examples=30)
@given(st.lists(POINTS, max_size=5))
def test_results_survive_json(points: list[Point]) -> None:
    """As a document without nan, which JSON does not know."""
    before = results(tuple(points))
    text = json.dumps(before.to_dict(), allow_nan=False)
    after = Results.from_dict(json.loads(text))
    assert all(map(same, after.points, before.points))
    assert dataclasses.replace(after, points=()) == dataclasses.replace(
        before, points=()
    )


def test_files_are_written_and_read(tmp_path: Path) -> None:
    """Into a folder that did not exist; both hold the same points."""
    points = (Point("S1", "ours", "a, b", "Euler", cost=1.25),)
    table, document = write_results(results(points), tmp_path / "new" / "folder")
    assert all(map(same, read_results(document).points, points))
    assert all(map(same, points_from_csv(table.read_text()), points))


@pytest.mark.parametrize("text", ["", "{}", '{"layout_version": 99}', "[1]"])
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    """With one sentence that names the file or the layout."""
    file = tmp_path / "results.json"
    file.write_text(text)
    with pytest.raises(ResultsError, match=r"results|layout"):
        read_results(file)


def test_machine_tells_no_names() -> None:
    """The files are published: the processor, and neither host nor user nor folder."""
    import getpass
    import platform

    found = machine()
    assert found["processor"]
    assert found["cores"] >= 1
    text = " ".join(map(str, found.values()))
    assert platform.node() not in text
    assert getpass.getuser() not in text.split()
    assert "/" not in text


def test_times_are_shown() -> None:
    """A table each of steps, impacts and waves, and why something is missing."""
    console = Console(record=True, width=120, markup=False)
    show(results(()), console)
    text = console.export_text()
    for heading in ("single steps", "one impact of a row", "through long rows"):
        assert heading in text
    assert "not measured, not installed: dart" in text
