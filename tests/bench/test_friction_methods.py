"""The benchmark of friction, on tiny runs; no wall time is asserted."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation
from typer.testing import CliRunner

from mujoco_impact.errors import SceneError
from mujoco_impact_lab.__main__ import app
from mujoco_impact_lab.bench import friction
from mujoco_impact_lab.bench.friction import benchmark, box, falling, rack
from mujoco_impact_lab.bench.friction.engines import ENGINES
from mujoco_impact_lab.bench.friction.methods import MujocoMotions, mujoco_settings
from mujoco_impact_lab.bench.friction.page import BEGIN
from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS
from mujoco_impact_lab.bench.page import END
from mujoco_impact_lab.bench.results import read_results

ROOT = Path(__file__).parents[2]


def error(scene, method: str, integrator: str = "Euler") -> float:
    """Of a method with its first setting at 2 ms."""
    setting = next(
        one
        for one in mujoco_settings(scene)
        if (one.method, one.integrator, one.timestep) == (method, integrator, 2e-3)
    )
    return scene.error(setting.build(scene).record())


@pytest.mark.parametrize("make", [rack.billiard_break, box.bouncing_box])
def test_ours_is_near_the_truth_and_mujocos_defaults_are_not(make):
    scene = make()
    # as the law is on the rows, 1e-4 and 1e-3; RK4, for Euler turns boxes by 5e-4
    assert error(scene, OURS, "RK4") < 5e-4
    assert error(scene, DEFAULT) > 0.1


def test_nothing_is_nearer_than_the_truth_is_good():
    scene = rack.billiard_break()
    exact = dataclasses.replace(scene, outcome=lambda row: row)
    assert exact.error(list(scene.truth)) == 0
    rough = dataclasses.replace(exact, accuracy=0.01)
    assert rough.error(list(scene.truth)) == 0.01
    shift = np.eye(1, scene.truth.shape[1])[0] * 0.02
    assert rough.error(list(scene.truth + shift)) == pytest.approx(0.02, rel=1e-12)
    assert np.isnan(rough.error(list(scene.truth * np.nan)))


def test_a_break_has_the_momentum_of_its_cue_ball():
    scene = rack.billiard_break()
    after = scene.truth.reshape(len(scene.starts), rack.BALLS, 6)
    # of the truth, in the cue's: 1 along x, none across
    momentum = after[..., :3].sum(axis=1) * np.sqrt(rack.BALLS)
    np.testing.assert_allclose(momentum, [[1, 0, 0]] * 2, atol=1e-9)


def test_a_box_strikes_once():
    """At the time that is meant; and it is off the floor from then to the end."""
    corners = (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1) * box.HALF

    def height(turn: Rotation) -> float:
        return float(-turn.apply(corners)[:, 2].min())

    scene = box.bouncing_box()
    assert len(scene.truth) == 4
    for k, (qpos, qvel) in enumerate(scene.starts):
        onset = box.FLIGHT + k * box.LATER
        turn = Rotation.from_quat(qpos[3:], scalar_first=True)
        L = turn.apply(box.INERTIA * qvel[3:])
        for elapsed in np.linspace(0, onset, 8):
            there = box.free_turn(qpos[3:], L, elapsed)
            above = qpos[2] + qvel[2] * elapsed - height(there)
            assert above > 0 or elapsed == onset
        # rows have 12 digits
        assert above == pytest.approx(0, abs=1e-9)
        after = scene.truth[k, 3:] * box.INERTIA.mean() / box.HALF.max()
        quaternion = there.as_quat(scalar_first=True)
        for later in np.linspace(1e-3, box.DURATION - onset, 12):
            turned = box.free_turn(quaternion, after, later)
            assert height(there) + scene.truth[k, 2] * later > height(turned)


def test_a_free_box_turns_back_the_way_it_came():
    """And evenly about an axis of its own."""
    momentum = np.array([0.01, -0.02, 0.015])
    start = Rotation.from_rotvec([0.3, 0.2, -0.5]).as_quat(scalar_first=True)
    there = box.free_turn(start, momentum, 0.1)
    back = box.free_turn(there.as_quat(scalar_first=True), momentum, -0.1)
    assert (
        back * Rotation.from_quat(start, scalar_first=True).inv()
    ).magnitude() < 1e-8
    about_z = box.free_turn(np.array([1.0, 0, 0, 0]), 3 * box.INERTIA[2] * UP, 0.1)
    np.testing.assert_allclose(about_z.as_rotvec(), 0.3 * UP, atol=1e-9)


UP = np.array([0.0, 0.0, 1.0])

ONE = falling.Row(
    count=1, height=0.048, thickness=0.008, mass=0.01, pitch=0.036, friction=0.3,
    restitution=0.3, gravity=9.81,
)  # fmt: skip


def test_one_domino_falls_about_its_edge():
    """A pendulum upside down: w^2 = w0^2 + 2 m g (z0 - z) / I about the edge."""
    push, angle = 4.0, 0.3
    reach = np.hypot(ONE.height, ONE.thickness) / 2
    lean = np.arctan2(ONE.thickness, ONE.height)

    def slowness(turned: float) -> float:
        sunk = reach * (np.cos(lean) - np.cos(lean - turned))
        return (push**2 + 1.5 * ONE.gravity * sunk / reach**2) ** -0.5

    expected = quad(slowness, 0, angle)[0]
    found = falling.arrivals(ONE, [push], angle, stiffness=1e8, timestep=5e-5)
    # the edge gives way at first: 1.3 % at a hundredth of this stiffness
    assert found[0] == pytest.approx(expected, rel=5e-3)


def test_stiffer_dominoes_fall_as_fast():
    """Two of them: the second begins when the first has come to it, and is slower."""
    two = dataclasses.replace(ONE, count=2)
    pushes = [3.5, 4.5]
    soft = falling.arrivals(two, pushes, 0.05, stiffness=1e6, timestep=1e-4)
    stiff = falling.arrivals(two, pushes, 0.05, stiffness=1e7, timestep=1e-4)
    # the soft floor: 0.6 and 0.5 %; a single stone has 1.3 %
    np.testing.assert_allclose(soft, stiff, rtol=2e-2)
    met = np.arcsin((ONE.pitch - ONE.thickness) / ONE.height)
    alone = falling.arrivals(ONE, pushes, met, stiffness=1e7, timestep=1e-4)
    assert np.all(stiff > alone + 0.005)
    slippery = dataclasses.replace(two, friction=0.1)
    other = falling.arrivals(slippery, pushes, 0.05, stiffness=1e7, timestep=1e-4)
    # the feet give way, 0.8 and 1.8 %
    assert np.all(np.abs(other / stiff - 1) > 0.005)


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("make", [rack.billiard_break, box.bouncing_box])
@pytest.mark.filterwarnings("default")
def test_other_engines_start_and_fly_as_ours(name, make):
    """Masses, places, turns and spins are those of MuJoCo's scene."""
    package, engine, *_ = ENGINES[name]
    pytest.importorskip(package)
    scene = dataclasses.replace(make(), duration=0.02)
    if benchmark.obstacle(name, scene):
        pytest.skip("knows the plane only")
    free = MujocoMotions(scene, scene.spec(1e-4)).record()
    for start, motion, ours in zip(
        scene.starts, engine(scene, 1e-3).record(), free, strict=True
    ):
        np.testing.assert_allclose(motion.qpos[0], start[0], atol=1e-9)
        np.testing.assert_allclose(motion.qvel[0], start[1], atol=1e-9)
        # a millimetre of 20 mm, and .02 rad of .2: steps of 1 ms
        np.testing.assert_allclose(motion.qpos[-1], ours.qpos[-1], atol=1e-3)


def test_the_command_writes_everything(tmp_path):
    page, out = tmp_path / "page.md", tmp_path / "out"
    page.write_text(f"before\n\n{BEGIN}\nold\n{END}\nafter\n")
    ran = CliRunner().invoke(
        app,
        ["friction", "--quick", "--scenes", "box", "--out", str(out),
         "--page", str(page)],
    )  # fmt: skip
    assert ran.exit_code == 0, ran.output
    results = read_results(out / "results.json")
    assert {OURS, DEFAULT} < {point.method for point in results.points}
    for point in results.points:
        assert point.failure == ""
        assert point.cost > 0
    table = friction.friction_table(results)
    assert len(table.splitlines()) == 3
    assert page.read_text() == f"before\n\n{BEGIN}\n{table}{END}\nafter\n"
    assert (out / "box.png").read_bytes().startswith(b"\x89PNG")
    assert "exudyn" in ran.output  # not measured, and why
    assert str(tmp_path) not in (out / "results.json").read_text()


def test_unknown_scenes_and_absent_engines_are_told(monkeypatch):
    with pytest.raises(SceneError, match=r"'pool'.*break, box, dominoes"):
        friction.run_friction(scenes=["pool"])
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    monkeypatch.setattr(benchmark, "_points", lambda *_: [])
    missing = friction.run_friction(scenes=["box"]).missing
    assert "not installed" in missing["dart on box"]
    assert "not installed" in missing["pymunk on box"]


def test_the_page_shows_the_committed_results():
    folder = ROOT / "docs" / "benchmarks"
    text = (folder / "README.md").read_text(encoding="utf-8")
    table = text.partition(f"{BEGIN}\n")[2].partition(END)[0]
    results = read_results(folder / "friction" / "results.json")
    assert table == friction.friction_table(results)
    # headings, and three scenes
    assert len(table.splitlines()) == 5
