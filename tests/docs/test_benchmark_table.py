"""The table of run time and error in docs/validation.md is that of the results."""

from pathlib import Path

import pytest

from mujoco_impact_lab.bench.page import BEGIN, END, page_table, with_table, write_table
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import ResultsError, points_from_csv, read_results
from mujoco_impact_lab.bench.summary import summarize

ROOT = Path(__file__).parents[2]
BENCHMARKS = ROOT / "docs" / "benchmarks"


def committed() -> tuple[Point, ...]:
    return points_from_csv((BENCHMARKS / "results.csv").read_text(encoding="utf-8"))


def test_the_page_shows_the_committed_results():
    text = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
    table = text.partition(f"{BEGIN}\n")[2].partition(END)[0]
    assert table == page_table(committed())
    # headings, and five scenes
    assert len(table.splitlines()) == 7


def test_both_files_of_results_say_the_same():
    results = read_results(BENCHMARKS / "results.json")
    assert summarize(results.points) == summarize(committed())


def test_a_line_of_the_table_says_what_was_measured():
    """By hand: cost and errors of each column, rounded."""

    def point(method: str, cost: float, error: float, **more: str | float) -> Point:
        shared = {"integrator": "Euler", "setting": "defaults", "timestep": 2e-3}
        numbers = {"cost": cost, "velocity_error": error}
        return Point(scene="S1", method=method, **{**shared, **numbers, **more})

    points = [
        point("ours", 1.02, 6.2e-6),
        point("ours", 4.0, 5e-7, timestep=5e-4),
        point("mujoco-default", 1.0, 0.432),
        point("mujoco-damper", 0.9, 0.0148, setting="damper"),
        point("mujoco-hertz", 2.0, 1e-3, setting="too dear"),
        point("exudyn", 11.3, 7.7e-9),
    ]
    cells = [
        "3 touching balls", "2 ms, Euler", "1.02", "6e-6", "0.4", "1e-2",
        "8e-9 (Exudyn, 11)",
    ]  # fmt: skip
    assert page_table(points).splitlines()[2] == f"| {' | '.join(cells)} |"


def test_only_the_table_of_a_page_is_written(tmp_path):
    """And writing it twice changes nothing."""
    file = tmp_path / "page.md"
    file.write_text(f"before\n\n{BEGIN}\nold\n{END}\nafter\n")
    for _ in range(2):
        write_table(BENCHMARKS / "results.csv", file)
        table = page_table(committed())
        assert file.read_text() == f"before\n\n{BEGIN}\n{table}{END}\nafter\n"


@pytest.mark.parametrize("text", ["", f"{BEGIN}\n", f"{END}\n", f"{END}\n{BEGIN}\n"])
def test_a_page_without_a_place_is_refused(text):
    with pytest.raises(ResultsError, match="must stand in the text"):
        with_table(text, "")
