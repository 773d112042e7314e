"""The picture of a sweep shows what was varied against what was recorded."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import mujoco_impact
from mujoco_impact.errors import SweepError
from mujoco_impact.sweeping import plot

pytest.importorskip("matplotlib")


def figure_of(given: dict[str, Any]) -> Any:
    return plot.sweep_figure(mujoco_impact.sweep(given, processes=1))


def labels(axis: Any) -> list[str]:
    return axis.get_legend_handles_labels()[1]


def test_a_line_for_each_method_over_what_was_varied(given):
    given |= {
        "record": ["velocity_error", "energy_lost"],
        "grid": {
            "method": ["mujoco-impact", "MuJoCo as is"],
            "mass": {"right": [0.1, 0.2, 10.0]},
        },
    }
    figure = figure_of(given)
    top, bottom = figure.axes
    assert labels(top) == ["mujoco-impact", "MuJoCo as is"]
    assert top.get_ylabel() == "velocity error [impact speed]"
    assert bottom.get_ylabel() == "energy lost [energy of motion]"
    assert bottom.get_xlabel() == "mass of right [kg]"
    assert bottom.get_xscale() == "log"
    ours, native = top.get_lines()
    assert list(ours.get_xdata()) == [0.1, 0.2, 10.0]
    assert max(ours.get_ydata()) < min(native.get_ydata())


def test_what_was_recorded_may_stand_along_the_axis(given):
    given |= {
        "record": ["impact_speed", "impulse"],
        "grid": {"speed_factor": [2.0, 1.0]},
        "plot": {"x": "impact_speed", "y": "impulse", "title": "Two balls"},
    }
    figure = figure_of(given)
    (axis,) = figure.axes
    assert axis.get_xlabel() == "impact speed [m/s]"
    (line,) = axis.get_lines()
    assert list(line.get_xdata()) == pytest.approx([1.0, 2.0], rel=1e-9)
    assert list(line.get_ydata()) == pytest.approx([0.1, 0.2], rel=1e-9)
    assert figure.get_suptitle() == "Two balls"


def test_random_draws_are_dots(given):
    given |= {
        "record": ["impulse"],
        "grid": {},
        "random": {
            "cases": 3,
            "seed": 1,
            "mass": {"right": {"uniform": [0.1, 0.2]}},
            "attach": {"restitution": {"uniform": [0, 1]}},
        },
    }
    figure = figure_of(given)
    assert len(figure.axes) == 2
    for axis in figure.axes:
        (line,) = axis.get_lines()
        assert line.get_linestyle() == "None"
        assert len(line.get_xdata()) == 3


def test_repeats_are_their_median_and_failures_are_told(given):
    given |= {
        "record": ["run_time"],
        "repeats": 3,
        "grid": {"attach": {"restitution": [1.0, 0.5, 1.5]}},
    }
    found = mujoco_impact.sweep(given, processes=1)
    figure = plot.sweep_figure(found)
    (axis,) = figure.axes
    (line,) = axis.get_lines()
    times = sorted(row["run_time"] for row in found.rows if row["case"] == 1)
    assert line.get_ydata()[0] == times[1]
    assert figure.get_suptitle() == "two_balls (3 of 9 failed)"


def test_texts_stand_along_the_axis_if_nothing_else_was_varied(given, tmp_path):
    given |= {"record": ["impulse"], "grid": {"integrator": ["RK4", "Euler"]}}
    found = mujoco_impact.sweep(given, processes=1)
    assert found.plot(tmp_path / "a.svg") == tmp_path / "a.svg"
    assert "<svg" in Path(tmp_path / "a.svg").read_text()
    (axis,) = plot.sweep_figure(found).axes
    assert list(axis.get_lines()[0].get_xdata()) == ["RK4", "Euler"]


def test_what_cannot_be_drawn_is_told(given, tmp_path):
    found = mujoco_impact.sweep({**given, "grid": {}}, processes=1)
    with pytest.raises(SweepError, match="no number was varied"):
        found.plot(tmp_path / "a.png")
    given["plot"] = {"x": "speed"}
    found = mujoco_impact.sweep(given, processes=1)
    with pytest.raises(SweepError, match=r"plot.x: no column 'speed' .available: case"):
        found.plot(tmp_path / "a.png")
