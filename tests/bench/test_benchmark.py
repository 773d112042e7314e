"""The benchmark itself, on tiny runs; no wall time is asserted."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.runner import initial_data, load_model
from mujoco_impact.scene import attach
from mujoco_impact_lab.__main__ import app
from mujoco_impact_lab.bench import (
    benchmark,
    measure,
    mujoco_methods,
    sequential,
    step_cases,
    steps,
)
from mujoco_impact_lab.bench.benchmark import choose_methods, run_benchmark
from mujoco_impact_lab.bench.library import LIBRARY_VARIABLE
from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import points_from_csv, read_results
from mujoco_impact_lab.bench.scenes import SCENES, choose_scenes
from mujoco_impact_lab.bench.simulate import START
from mujoco_impact_lab.bench.truths import Truth, row_errors, truth_of

# Velocities after the first impact over the impact speed, from integrations of the
# Hertz contacts by other programs (four published digits).
PUBLISHED = {
    "S1": (-0.0710, 0.0764, 0.9945),
    "S2": (-0.0711, -0.0303, -0.0145, 0.1270, 0.9888),
    "S3": (-0.1126, -0.0420, 0.2145, 0.8004, 1.1397),
    "S4": (0.1621, 0.3174, 1.3594),
    "gaps": (0.0, 0.0, 0.0, 0.0, 1.0),
}


@pytest.fixture(scope="module")
def truth() -> Truth:
    """The truth of three touching balls."""
    return truth_of(SCENES["S1"])


def candidate(method: str, timestep: float | None = 0.002):
    """The first setting of a method at a timestep."""
    (family,) = choose_methods([method])
    return next(one for one in family.candidates if one.timestep == timestep)


@pytest.mark.parametrize("name", PUBLISHED)
def test_truth_is_the_published_one(name: str) -> None:
    """Half of the last digit, and what gravity does within an impact (1e-5)."""
    scene = dataclasses.replace(SCENES[name], swings=False)
    np.testing.assert_allclose(truth_of(scene).velocities, PUBLISHED[name], atol=7e-5)


def test_command_writes_everything(tmp_path: Path) -> None:
    """One scene, two methods: CSV, JSON, a chart; ours is right."""
    out, document = tmp_path / "out", tmp_path / "copy.json"
    ran = CliRunner().invoke(
        app,
        [
            "bench", "--quick", "--no-steps", "--scenes", "S1",
            "--methods", f"{OURS},{DEFAULT}", "--out", str(out),
            "--json", str(document),
        ],
    )  # fmt: skip
    assert ran.exit_code == 0, ran.output
    results = read_results(out / "results.json")
    assert json.loads(document.read_text()) == results.to_dict()
    points = results.points
    assert len(points_from_csv((out / "results.csv").read_text())) == len(points)
    assert {point.method for point in points} == {OURS, DEFAULT}
    for point in points:
        assert point.failure == ""
        assert point.cost > 0
        assert point.run_time > 0
    by_setting = {(p.method, p.timestep, p.integrator): p for p in points}
    ours = by_setting[OURS, 0.002, "Euler"]
    # measured 6e-6 and 1e-5; one order of margin, and four below MuJoCo's defaults
    assert ours.velocity_error < 1e-4
    assert ours.angle_rms < 1e-4
    assert abs(ours.energy_drift) < 1e-3
    assert by_setting[DEFAULT, 0.002, "Euler"].velocity_error > 0.3
    chart = (out / "S1.png").read_bytes()
    assert chart.startswith(b"\x89PNG")
    assert len(chart) > 30_000
    assert (out / "overview.png").read_bytes().startswith(b"\x89PNG")
    # the summary is printed, and kept
    assert "at the run time of MuJoCo's defaults" in ran.output
    (velocity, angle) = results.to_dict()["summary"]
    assert (velocity["error"], angle["error"]) == ("velocity_error", "angle_rms")
    assert velocity["default"] > 0.3
    assert str(tmp_path) not in (out / "results.json").read_text()


def test_sequential_impacts_are_those_of_textbooks(truth: Truth) -> None:
    """e = 1 passes everything on; e < 1 by hand: (1-e)/2 and (1+e)/2 at each pair."""
    chain = truth.chain
    start = np.array([1.0, 0.0, 0.0])
    hanging = np.zeros(3)
    left = sequential.collide(chain, hanging, start, 1.0)
    np.testing.assert_allclose(left, [0, 0, 1], atol=1e-12)
    for e in (0.9, 0.5):
        keep, give = (1 - e) / 2, (1 + e) / 2
        after = [keep, give * keep, give**2]
        # ball 1 is faster than ball 2 then, and the pair meets again, and so on
        left = sequential.collide(chain, hanging, start, e)
        assert left.sum() == pytest.approx(1.0)
        assert np.all(np.diff(left) >= -1e-9)
        assert left[2] >= after[2] - 1e-12
        assert left[0] == pytest.approx(after[0], abs=keep * give * keep)


def test_sequential_swing_keeps_its_energy(truth: Truth) -> None:
    """And is as far from the Hertz cradle as pairwise impacts are known to be."""
    scene = SCENES["S1"]
    simulation = sequential.SequentialSimulation(scene, truth)
    errors = row_errors(scene, truth, simulation.record())
    assert abs(errors.energy_drift) < 1e-12
    # published: 0.0603, from (0, 0, 1) against the velocities above
    assert errors.velocity == pytest.approx(0.0603, abs=1e-4)


def test_error_of_the_truth_is_zero(truth: Truth) -> None:
    """What is measured is the difference from the reference and nothing else."""
    from mujoco_impact_lab.bench.samples import Samples

    times = np.arange(1501) * 0.002
    samples = Samples(times, *truth.motion(times))
    errors = row_errors(SCENES["S1"], truth, samples)
    # rounding of the elliptic functions
    assert errors.velocity < 1e-9
    assert errors.angle_rms < 1e-9
    shifted = dataclasses.replace(samples, angles=samples.angles + 1e-3)
    assert row_errors(SCENES["S1"], truth, shifted).angle_rms == pytest.approx(1e-3)


@pytest.mark.parametrize("name", ["strings", "overlap", "e09"])
def test_other_scenes_are_measured_too(name: str) -> None:
    """Ours is right in each of them within the error of its truth (4e-4)."""
    scene = SCENES[name]
    if scene.swings:
        scene = dataclasses.replace(scene, swings=False, duration=0.5)
    bench = measure.SceneBench(scene, truth_of(scene), measure.QUICK)
    ours = bench.point(candidate(OURS))
    assert ours.velocity_error < 5e-4
    assert bench.point(candidate(DEFAULT)).velocity_error > 0.1


def test_failure_is_a_point(truth: Truth) -> None:
    """A method that diverges has a reason instead of numbers."""

    def explosive(spec: mujoco.MjSpec, *_: object) -> mujoco.MjSpec:
        for geom in spec.geoms:
            geom.solref = (0.0, -1e7)
        return spec

    broken = mujoco_methods._candidate("x", "explosive", 0.002, explosive)
    point = measure.SceneBench(SCENES["S1"], truth, measure.QUICK).point(broken)
    assert "MuJoCo gave a warning" in point.failure
    assert math.isnan(point.cost)


def test_unknown_names_are_refused() -> None:
    """With the names there are."""
    with pytest.raises(SceneError, match=r"'S9'.*S1, S2"):
        choose_scenes(["S9"])
    with pytest.raises(ConfigError, match=r"'chipmunk'.*pymunk"):
        choose_methods(["chipmunk"])


def test_what_is_missing_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that is not installed, and one that does not know a scene."""
    monkeypatch.delenv(LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    monkeypatch.setattr(benchmark, "_scene_points", lambda *_: [])
    methods = ["dart", "exudyn", "compiled-hertz", "sequential"]
    results = run_benchmark(scenes=["strings"], methods=methods, steps=False)
    assert "not installed" in results.missing["dart"]
    assert "not installed" in results.missing["exudyn"]
    assert LIBRARY_VARIABLE in results.missing["compiled-hertz"]
    assert "pendulum rows only" in results.missing["sequential on strings"]


def test_every_scene_of_the_steps_loads_with_its_floor() -> None:
    """With the plugin and without; names and headings are unique."""
    cases = step_cases.step_cases(library=False)
    assert len({case.title for case in cases}) == len(cases)
    for case in cases:
        # long ones take a second each to compile, and are made by the same functions
        if case.balls <= 100:
            ours, floor = map(load_model, case.specs())
            assert (ours.nplugin, floor.nplugin) == (1, 0)
            assert ours.ngeom == floor.ngeom == case.balls


@pytest.mark.usefixtures("library")
def test_empty_plugin_is_called_and_does_nothing() -> None:
    """The row swings as without it."""
    *_, case = step_cases.step_cases(library=True)
    assert "empty plugin" in case.title
    empty, floor = map(load_model, case.specs())
    assert (empty.nplugin, floor.nplugin) == (1, 0)
    assert empty.nsensordata == 1
    for one, other in zip(
        steps._motion(empty, 100), steps._motion(floor, 100), strict=True
    ):
        np.testing.assert_array_equal(one, other)


def test_steps_are_timed_and_summed_up() -> None:
    """One step less than the motion has: the first one does not count."""
    case = step_cases.step_cases(library=False)[0]
    (row,) = steps.step_times(duration=0.2, repeats=2, cases=[case])
    assert (row.case, row.balls, row.steps) == ("3 swinging balls", 3, 99)
    assert 0 < row.p50 <= row.p99 <= row.worst <= row.disturbed
    assert row.ratio == pytest.approx(row.mean / row.floor)
    assert row.per_ball == pytest.approx(row.mean / 3)
    assert row.floor_per_ball == pytest.approx(row.floor / 3)


def test_floor_sees_the_same_contacts() -> None:
    """From the same states: as many, as deep, all of them left to nobody."""
    attached = attach(SCENES["S2"].spec())
    ours, floor = load_model(attached), load_model(step_cases.floor(attached))
    assert (ours.nplugin, floor.nplugin) == (1, 0)
    states = steps._motion(ours, 200)
    mine, bare = mujoco.MjData(ours), mujoco.MjData(floor)
    seen = 0
    for qpos, qvel in zip(*states, strict=True):
        for model, data in ((ours, mine), (floor, bare)):
            data.qpos[:], data.qvel[:] = qpos, qvel
            mujoco.mj_forward(model, data)
        assert mine.ncon == bare.ncon
        np.testing.assert_array_equal(mine.contact.dist, bare.contact.dist)
        np.testing.assert_array_equal(mine.contact.exclude, bare.contact.exclude)
        seen += mine.ncon
    assert seen >= 3 * 200


def test_replayed_motion_is_our_own() -> None:
    """Writing the recorded states changes nothing, so that impacts are timed, too."""
    attached = attach(SCENES["S1"].spec())
    model = load_model(attached)
    states = steps._motion(model, 200)
    data = initial_data(model, keyframe=START)
    times = steps._step_all(model, data, *states)
    assert times.shape == (200,)
    # in the end where the motion led
    model_again = steps._motion(model, 201)
    np.testing.assert_array_equal(data.qpos, model_again[0][-1])
    again = steps._motion(model, 200)
    np.testing.assert_array_equal(states[0], again[0])
    # the last ball has flown off within 0.4 s
    assert states[1][-1, -1] > 1.0


def test_points_of_a_scene_are_found() -> None:
    """`of_scene` picks by name."""
    results = run_benchmark(scenes=[], methods=[OURS], steps=False)
    assert results.points == ()
    mixed = dataclasses.replace(
        results, points=(Point("a", "x", "", ""), Point("b", "y", "", ""))
    )
    assert [point.method for point in mixed.of_scene("b")] == ["y"]


@pytest.mark.parametrize(
    ("method", "module", "tolerance"),
    [
        ("exudyn", "exudyn", 1e-6),
        # its joint is held at the level of velocities, and drifts
        ("pymunk", "pymunk", 5e-4),
        # second-order errors of a step of 2 ms: (h omega)^2 / 24 of 3 rad/s
        ("dart", "dartpy", 2e-5),
        ("pybullet", "pybullet", 2e-5),
    ],
)
@pytest.mark.filterwarnings("default")
def test_other_engines_swing_like_the_reference(
    method: str, module: str, tolerance: float, truth: Truth
) -> None:
    """Before the first impact: same masses, lengths and signs as ours."""
    pytest.importorskip(module)
    from mujoco_impact_lab.bench.truths import corrected

    (family,) = choose_methods([method])
    quick = next(one for one in family.candidates if one.quick)
    scene = dataclasses.replace(SCENES["S1"], duration=0.25)
    samples = quick.build(scene, truth).record()
    time, angles, velocities = corrected(samples, truth.chain)
    early = time < 0.24
    expected = truth.motion(time[early])
    np.testing.assert_allclose(angles[early], expected[0], atol=tolerance)
    # rad/s: angles change tenfold within a second
    np.testing.assert_allclose(velocities[early], expected[1], atol=10 * tolerance)


def test_what_was_measured_is_kept_on_control_c(monkeypatch, tmp_path):
    """The scenes that are done are written; exit code 130."""
    from mujoco_impact_lab.bench import benchmark as module

    usual = module._scene_points

    def stop(scene, *arguments):
        if scene.name == "S2":
            raise KeyboardInterrupt
        return usual(scene, *arguments)

    monkeypatch.setattr(module, "_scene_points", stop)
    done = CliRunner().invoke(
        app,
        ["bench", "--quick", "--scenes", "S1,S2", "--methods", "ours", "--out",
         str(tmp_path)],
    )  # fmt: skip
    assert done.exit_code == 130, done.output
    assert "interrupted after S1" in done.output
    assert (tmp_path / "results.csv").is_file()
