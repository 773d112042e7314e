"""Cases of a sweep: grid, list and random draws, and every combination of them."""

from __future__ import annotations

import inspect
from typing import Any

import pytest

import cradle_models
from mujoco_impact.errors import ConfigError
from mujoco_impact.sweeping.parameters import BUILDERS, unit_of
from mujoco_impact.sweeping.specification import read_specification

ROW = {"builder": "row", "pattern": "AAA"}


def cases_of(**tables: Any) -> list[dict[str, Any]]:
    document = {"scene": ROW, "duration": 0.5, "record": "impacts", **tables}
    specification = read_specification(document)
    return [
        {name: case[name] for name in specification.varied}
        for case in specification.cases
    ]


def test_a_grid_has_every_combination_the_last_parameter_fastest():
    found = cases_of(grid={"timestep": [0.001, 0.002], "integrator": ["Euler", "RK4"]})
    assert [tuple(case.values()) for case in found] == [
        (0.001, "Euler"),
        (0.001, "RK4"),
        (0.002, "Euler"),
        (0.002, "RK4"),
    ]


def test_a_range_goes_evenly_or_by_equal_factors():
    even = cases_of(grid={"scene": {"release": {"from": 1, "to": 3, "count": 5}}})
    assert [case["scene.release"] for case in even] == [1.0, 1.5, 2.0, 2.5, 3.0]
    log = {"from": 1, "to": 4, "count": 3, "spacing": "log"}
    values = [c["scene.release"] for c in cases_of(grid={"scene": {"release": log}})]
    assert values == pytest.approx([1.0, 2.0, 4.0], rel=1e-15)


def test_a_list_pairs_its_values():
    found = cases_of(
        list={"method": ["MuJoCo damper", "mujoco-impact"], "timestep": [0.001, 0.002]}
    )
    assert [tuple(case.values()) for case in found] == [
        ("MuJoCo damper", 0.001),
        ("mujoco-impact", 0.002),
    ]


def drawn(seed: int = 3, cases: int = 40, **more: Any) -> list[dict[str, Any]]:
    return cases_of(
        random={
            "cases": cases,
            "seed": seed,
            "attach": {"young": {"log_uniform": [1e9, 1e11]}},
            "scene": {"release": {"uniform": [10, 20]}},
            **more,
        }
    )


def test_random_draws_are_those_of_the_seed_and_within_their_bounds():
    found = drawn(integrator={"choice": ["Euler", "RK4"]})
    assert found == drawn(integrator={"choice": ["Euler", "RK4"]})
    assert found != drawn(seed=4, integrator={"choice": ["Euler", "RK4"]})
    assert len(found) == 40
    young = [case["attach.young"] for case in found]
    release = [case["scene.release"] for case in found]
    assert 1e9 <= min(young) < 1e10 < max(young) <= 1e11
    assert 10 <= min(release) < 15 < max(release) <= 20
    assert {case["integrator"] for case in found} == {"Euler", "RK4"}


def test_draws_stay_as_they_are_with_more_cases_and_more_parameters():
    few = drawn(cases=3)
    more = drawn(cases=9, timestep={"uniform": [0.001, 0.002]})
    assert [{name: case[name] for name in few[0]} for case in more[: len(few)]] == few


def test_all_three_are_combined():
    found = cases_of(
        random={"cases": 2, "seed": 0, "speed_factor": {"uniform": [1, 2]}},
        grid={"timestep": [0.001, 0.002]},
        list={"method": ["mujoco-impact", "MuJoCo damper"], "keyframe": ["none", 0]},
    )
    assert len(found) == 8
    assert [case["timestep"] for case in found] == [0.001, 0.001, 0.002, 0.002] * 2
    assert len({case["speed_factor"] for case in found}) == 2


def test_integers_beside_floats_are_floats():
    found = cases_of(grid={"scene": {"release": [30, 45.5]}})
    assert [repr(case["scene.release"]) for case in found] == ["30.0", "45.5"]


def test_every_function_that_makes_a_scene_is_a_builder():
    makers = {
        name
        for name in cradle_models.__all__
        if inspect.isfunction(maker := getattr(cradle_models, name))
        and inspect.signature(maker).return_annotation is str
    }
    assert makers - {"make_model"} == set(BUILDERS)


def test_units_are_those_of_the_documentation():
    assert unit_of("scene.release", "row") == "deg"
    assert unit_of("scene.gap", "row") == "m"
    assert unit_of("attach.young") == "Pa"
    assert unit_of("timestep") == "s"
    assert unit_of("mass.ball_1") == "kg"
    assert unit_of("attach.restitution") == ""
    assert unit_of("integrator") == ""


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"record": None}, "record is missing: must be a list of what to record"),
        ({"record": ["velocty_error"]}, "did you mean 'velocity_error'"),
        ({"record": ["impulse.left"]}, r"must be impulse.GEOM\+GEOM"),
        ({"record": ["impulse.a+a"]}, r"must be impulse.GEOM\+GEOM, two geoms"),
        ({"duration": None}, r"duration is missing: a time > 0 \[s\]"),
        ({"duration": "1 s"}, r"duration = '1 s': must be a time > 0 \[s\]"),
        ({"restitution": 1}, "no key 'restitution'; did you mean 'attach.restitution'"),
        ({"repeats": 0}, "repeats = 0: must be a whole number, 1 to"),
        ({"scene": {}}, "scene: give either model, a file"),
        ({"scene": "row_3"}, "scene = 'row_3': must be a table"),
        ({"scene": {**ROW, "relase": 3}}, "relase: row has no such argument; did you"),
        ({"scene": {"builder": "row"}}, "scene.pattern is missing: row needs it"),
        ({"scene": {"builder": "raw"}}, "'raw': not there; did you mean 'row'"),
        ({"scene": {"model": "row_3", "gap": 0}}, "only a builder has arguments"),
        ({"scene": {**ROW, "gap": float("nan")}}, "nan: allowed: .* a finite number"),
        ({"grid": {"timestep": 0.1}}, "must be a list of values, or a range such as"),
        ({"grid": {"timestep": [0]}}, r"grid.timestep = 0: must be a time > 0"),
        ({"grid": {"timestep": {"from": 1, "to": 2}}}, "a range has from, to, count"),
        ({"grid": {"method": ["damper"]}}, "there; did you mean 'MuJoCo damper'"),
        ({"grid": {"integrator": ["euler"]}}, "did you mean 'Euler'"),
        ({"grid": {"attach": {"yung": [1]}}}, "no 'yung'; did you mean 'young'"),
        ({"grid": {"restitution": [1]}}, "did you mean 'attach.restitution'"),
        ({"grid": {"tuned_for": [0]}}, "tuned_for = 0: must be a speed > 0"),
        ({"grid": {"timestep": [1e-6] * 1001, "repeat": []}}, "no such parameter"),
        ({"scene.builder": "row"}, "scene.builder is given twice"),
        ({"grid": {"mass": {"a": [1]}, "mass.a": [2]}}, "grid.mass.a is given twice"),
        ({"list": {"timestep": [1], "keyframe": ["a", "b"]}}, "must have as many"),
        ({"list": {"duration": [1]}}, "has a fixed value and stands in .list."),
        ({"random": {"seed": 0}}, "random.cases is missing: a whole number, 1 to"),
        ({"random": {"cases": 2, "seed": 0}}, "no parameter to draw"),
        (
            {"random": {"cases": 2, "seed": 0, "timestep": {"normal": [0, 1]}}},
            "must be { uniform = ",
        ),
        (
            {"random": {"cases": 2, "seed": 0, "timestep": {"log_uniform": [0, 1]}}},
            "both ends must be > 0",
        ),
        ({"plot": {"z": "impacts"}}, "plot.z: not there"),
    ],
)
def test_what_is_not_valid_is_named_with_what_is_allowed(change, message):
    document = {"scene": ROW, "duration": 0.5, "record": ["impacts"], **change}
    document = {key: value for key, value in document.items() if value is not None}
    with pytest.raises(ConfigError, match=message):
        read_specification(document)


def test_too_many_cases_are_refused_before_they_are_made():
    many = {"from": 1, "to": 2, "count": 1000}
    grid = {"scene": {"release": many, "length": many, "gravity": many}}
    with pytest.raises(ConfigError, match="1000000000 cases, allowed: 1000000"):
        read_specification(
            {"scene": ROW, "duration": 1, "record": "impacts", "grid": grid}
        )


def test_cases_and_repeats_have_a_bound_together():
    """Each alone is within its own."""
    many = {"from": 1, "to": 2, "count": 101}
    with pytest.raises(ConfigError, match="101 cases have 1010000 rows, allowed: 1000"):
        cases_of(grid={"scene": {"release": many}}, repeats=10_000)
