"""Strings, lattices and loose balls."""

import mujoco
import numpy as np
import pytest

import cradle_models as cm


def started(xml: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("release").id)
    mujoco.mj_forward(model, data)
    return model, data


def energy(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    mujoco.mj_energyPos(model, data)
    mujoco.mj_energyVel(model, data)
    return float(data.energy.sum())


def test_hanging_strings_hold_the_balls_in_place_and_together() -> None:
    model = mujoco.MjModel.from_xml_string(cm.two_string("ABA"))
    data = mujoco.MjData(model)
    for _ in range(500):
        mujoco.mj_step(model, data)
    # Soft limits sag by about g (2 h)^2 / 20, the same for every mass.
    moved = (data.qpos - model.qpos0).reshape(3, 7)
    np.testing.assert_allclose(moved[:, 2], -6e-6, atol=5e-6)
    assert np.abs(moved[:, :2]).max() < 1e-9
    assert np.ptp(moved[:, 2]) < 1e-7


def test_strings_are_taut_and_lifted_balls_hang_on_them_at_the_start() -> None:
    model, data = started(cm.two_string("AAA", released=2, release=40))
    np.testing.assert_allclose(data.ten_length, model.tendon_range[:, 1], rtol=1e-14)
    # The two lifted balls touch each other as they do at rest.
    assert abs(np.linalg.norm(data.geom_xpos[1] - data.geom_xpos[0]) - 0.03) < 1e-12


@pytest.mark.parametrize("name", ["two_string_3", "two_string_5"])
def test_the_toy_runs_stably_at_two_milliseconds(name: str) -> None:
    model, data = started(cm.make_model(name))
    lifted = energy(model, data)
    resting = float(np.sum(model.body_mass[1:]) * 9.81 * -0.3)
    for _ in range(1500):
        mujoco.mj_step(model, data)
        assert (data.ten_length < model.tendon_range[:, 1] + 5e-4).all()
        # Semi-implicit Euler lets the energy of a free swing waver by h^2 terms and by
        # half a step times the power of gravity: 0.6 %.
        assert energy(model, data) - resting < 1.01 * (lifted - resting)
    assert not data.warning.number.any()
    assert np.abs(data.geom_xpos[:, 1]).max() < 1e-9


def test_a_ball_on_strings_swings_as_far_as_it_was_lifted() -> None:
    model, data = started(cm.two_string("A"))
    reach = []
    for _ in range(1500):
        mujoco.mj_step(model, data)
        reach.append(data.geom_xpos[0, 0])
    # 0.15 m = 0.3 sin(30 deg); the strings stretch by micrometres.
    assert pytest.approx((-0.15, 0.15), abs=3e-4) == (min(reach), max(reach))


def test_lattice_neighbours_touch_in_x_and_in_y() -> None:
    rows, columns = 3, 4
    model = mujoco.MjModel.from_xml_string(cm.lattice(rows, columns))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    place = data.geom_xpos.reshape(rows, columns, 3)
    for axis in (0, 1):
        distance = np.linalg.norm(np.diff(place, axis=axis), axis=-1)
        np.testing.assert_allclose(distance, 0.03, atol=1e-12)
    assert model.geom("ball_2_3").id == columns + 2


def test_lattice_joints_move_a_ball_in_x_and_in_y() -> None:
    model = mujoco.MjModel.from_xml_string(cm.lattice(2, 2))
    data = mujoco.MjData(model)
    for joint, axis in (("hinge_x_1_2", 0), ("hinge_y_1_2", 1)):
        mujoco.mj_resetData(model, data)
        mujoco.mj_forward(model, data)
        before = data.geom("ball_1_2").xpos.copy()
        data.joint(joint).qpos = 0.2
        mujoco.mj_forward(model, data)
        moved = data.geom("ball_1_2").xpos - before
        assert pytest.approx(0.3 * np.sin(0.2)) == moved[axis]
        assert moved[1 - axis] == 0


def test_the_lattice_releases_a_column_or_a_corner() -> None:
    model, data = started(cm.lattice(3, 3, release=30))
    left = data.geom_xpos.reshape(3, 3, 3)[:, 0]
    np.testing.assert_allclose(left[:, 0], -0.03 - 0.15, atol=1e-12)
    model, data = started(cm.lattice(3, 3, release=30, released="corner"))
    moved = data.geom("ball_1_1").xpos - (-0.03, -0.03, -0.3)
    assert pytest.approx(moved[0]) == moved[1]
    assert pytest.approx(-0.15) == -np.hypot(moved[0], moved[1])
    assert moved[0] < 0
    assert np.count_nonzero(model.key("release").qpos) == 2


def test_of_many_free_balls_two_collide_and_the_others_stay() -> None:
    model, data = started(cm.free_balls(9, speed=0.5, distance=0.05))
    start = data.geom_xpos.copy()
    touched: set[tuple[int, ...]] = set()
    for _ in range(200):
        mujoco.mj_step(model, data)
        for contact in data.contact:
            touched.add(tuple(sorted(contact.geom)))
    assert touched == {(0, 1)}
    assert not (data.geom_xpos - start)[2:].any()
    # Momentum along x is conserved by equal and opposite contact forces.
    speeds = data.qvel.reshape(-1, 6)[:, 0]
    assert speeds[1] > 0.1
    assert pytest.approx(0.5, abs=1e-12) == speeds.sum()
