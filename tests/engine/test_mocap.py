"""Mocap bodies strike with the velocity with which they are moved."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact
from mujoco_impact.mujoco_warnings import collected_warnings

H, V = 2e-3, 1.0
"""Timestep [s] and speed of the paddle [m/s]."""

SCENE = """
<mujoco>
  <option timestep="0.002" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>
    <body name="paddle" mocap="true">
      <geom name="paddle" type="{shape}" size="{size}" condim="1"/>
      {carried}
    </body>
    <body name="ball" pos="{pos}">
      <freejoint/><geom name="ball" size=".02" mass=".1" condim="1"/>
    </body>
  </worldbody>
</mujoco>
"""

BOX = {"shape": "box", "size": ".01 .1 .1", "pos": ".0503 0 0", "carried": ""}


def scene(integrator="Euler", restitution=1.0, **parts):
    xml = SCENE.format(integrator=integrator, **BOX | parts)
    model = mujoco_impact.attach(xml, restitution=restitution).compile()
    return model, mujoco.MjData(model)


def push(model, data, steps=40, start=0.0) -> None:
    """Moves the paddle along x at V."""
    for k in range(steps):
        data.mocap_pos[0, 0] = start + k * V * H
        mujoco.mj_step(model, data)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_a_paddle_sends_a_resting_ball_off_at_one_plus_e_its_speed(
    integrator, restitution
):
    model, data = scene(integrator, restitution)
    push(model, data)
    assert data.qvel[0] == pytest.approx((1 + restitution) * V, rel=1e-12)
    assert data.sensor("impact").data[6] == 1
    # and from where they met, .0203 m from the start: no part of a step off
    time = 40 * H - 0.0203 / V
    start = 0.0503
    travel = (1 + restitution) * V * time
    assert data.qpos[0] - start == pytest.approx(travel, abs=1e-4)


def test_a_ball_that_comes_in_leaves_with_its_speed_and_twice_that_of_the_paddle():
    model, data = scene(shape="sphere", size=".03", pos=".08 0 0")
    data.qvel[0] = -0.5
    push(model, data, 30)
    assert data.qvel[0] == pytest.approx(0.5 + 2 * V, rel=1e-12)


def test_a_paddle_that_turns_strikes_with_the_speed_of_the_point():
    """A door about its middle: omega r at the place of the ball."""
    omega, arm = 5.0, 0.06
    model, data = scene(pos=f"{-arm} .042 0", size=".1 .01 .1")
    for k in range(30):
        angle = -omega * H * k
        data.mocap_quat[0] = np.cos(angle / 2), 0, 0, np.sin(angle / 2)
        mujoco.mj_step(model, data)
    assert data.sensor("impact").data[6] == 1
    ball = data.qvel[:3]
    normal = ball / np.linalg.norm(ball)
    point = model.body("ball").pos - 0.02 * normal
    closing = np.cross([0, 0, -omega], point) @ normal
    # the normal of a box is that of the start of the step, 0.01 rad before
    assert np.linalg.norm(ball) == pytest.approx(2 * closing, rel=1e-2)
    assert 2 * closing > omega * arm


def test_what_hangs_on_a_mocap_body_moves_with_it():
    """A slider of the mass of the ball hands the speed of its base on."""
    slider = (
        '<body name="slider" pos=".02 0 0"><joint type="slide" axis="1 0 0"/>'
        '<geom name="slider" size=".02" mass=".1" condim="1"/></body>'
    )
    model, data = scene(carried=slider, pos=".0803 0 0")
    push(model, data, 20)
    ball = data.joint(1).qvel
    assert ball[0] == pytest.approx(V, rel=1e-12)
    assert data.joint(0).qvel[0] == pytest.approx(-V, rel=1e-12)


def test_a_paddle_that_jumps_strikes_as_if_it_were_still_and_says_so_once():
    model, data = scene(pos=".9 0 0")
    mujoco.mj_step(model, data)
    data.qvel[0] = -0.1
    data.mocap_pos[0, 0] = 0.8697  # .3 mm from the ball
    with collected_warnings() as messages:
        for _ in range(5):
            mujoco.mj_step(model, data)
    assert data.qvel[0] == pytest.approx(0.1, rel=1e-12)
    (message,) = [text for text in messages if "mocap" in text]
    assert "'paddle'" in message
    assert "size in one step" in message


def test_it_is_still_in_the_first_step_and_after_a_reset():
    model, data = scene(pos=".0503 0 0")
    push(model, data, 5)
    mujoco.mj_resetData(model, data)
    data.mocap_pos[0, 0] = 0.0202  # .1 mm from the ball
    with collected_warnings() as messages:
        mujoco.mj_step(model, data)
    assert not messages
    assert np.all(data.qvel == 0)


def test_looking_ahead_changes_nothing_and_a_copied_state_goes_on():
    model, data = scene()
    other = mujoco.MjData(model)
    everything = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.empty(mujoco.mj_stateSize(model, everything))
    push(model, data, 8)
    mujoco.mj_getState(model, data, state, everything)
    mujoco.mj_setState(model, other, state, everything)
    for k in range(8, 20):
        for simulation in (data, other):
            simulation.mocap_pos[0, 0] = k * V * H
            for _ in range(3 if simulation is other else 0):
                mujoco.mj_forward(model, simulation)
            mujoco.mj_step(model, simulation)
        np.testing.assert_array_equal(other.qpos, data.qpos)
        np.testing.assert_array_equal(other.qvel, data.qvel)
        assert data.mocap_pos[0, 0] == k * V * H
    assert data.sensor("impact").data[6] == 1


PRESS = """
<mujoco><option timestep="{timestep}" integrator="{integrator}"/>
  <worldbody><geom type="plane" size="1 1 .1"/>
    <body mocap="true" pos="0 0 .12"><geom type="box" size=".1 .1 .03"/></body>
    <body pos="0 0 .04"><freejoint/><geom type="{shape}" size=".04 .04 .04"/></body>
  </worldbody>
</mujoco>"""


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("integrator", ["implicitfast", "RK4"])
@pytest.mark.parametrize("timestep", [5e-4, 5e-3])
@pytest.mark.parametrize("shape", ["box", "sphere"])
def test_what_a_mocap_body_presses_on_the_floor_is_held(
    shape, timestep, integrator, restitution
):
    """No impulse stops both contacts; bounces between them threw it at 1e25 m/s."""
    xml = PRESS.format(timestep=timestep, integrator=integrator, shape=shape)
    model = mujoco_impact.attach(xml, restitution=restitution).compile()
    data = mujoco.MjData(model)
    speed, fastest = 0.3, 0.0
    for step in range(1, round(0.2 / timestep)):
        # .1 mm lower than there is room
        data.mocap_pos[0, 2] = max(0.12 - speed * step * timestep, 0.1099)
        mujoco.mj_step(model, data)
        fastest = max(fastest, np.abs(data.qvel).max())
    # no faster than it is struck, elastically
    assert fastest < 2.1 * speed
    assert data.qpos[2] == pytest.approx(0.04, abs=1e-3)


@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.5])
def test_what_a_mocap_body_presses_against_a_joint_stop_is_held(restitution):
    xml = """
    <mujoco><option timestep=".005"/>
      <worldbody>
        <body mocap="true" pos=".15 -.06 0"><geom size=".02"/></body>
        <body><joint axis="0 0 1" range="-90 0"/>
          <geom type="box" size=".1 .01 .1" pos=".1 0 0"/></body>
      </worldbody>
    </mujoco>"""
    model = mujoco_impact.attach(xml, restitution=restitution).compile()
    data = mujoco.MjData(model)
    fastest = 0.0
    for step in range(600):
        data.mocap_pos[0, 1] = min(-0.06 + 0.1 * step * 0.005, -0.0295)
        mujoco.mj_step(model, data)
        fastest = max(fastest, np.abs(data.qvel).max())
    # .1 m/s at .15 m, elastically at most
    assert 0.1 < fastest < 1.4
    assert abs(data.qvel[0]) < 1e-3
