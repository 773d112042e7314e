"""Balls that MuJoCo has put to sleep are struck like any others."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact

BALL = """
<body pos="{x} 0 0"><joint type="slide" axis="1 0 0"/>
  <joint type="slide" axis="0 1 0"/><geom size=".01" mass=".1"/></body>
"""

SCENE = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0" sleep_tolerance="1e-3"
          integrator="{integrator}"><flag sleep="{sleep}"/></option>
  <worldbody>{balls}</worldbody>
</mujoco>
"""

PLACES = (-0.1, 0.0, 0.0205)
"""The second and the third wait for the first, half a millimetre apart [m]."""

STEPS = 120


def scene(integrator, *, sleep=True):
    xml = SCENE.format(
        integrator=integrator,
        sleep="enable" if sleep else "disable",
        balls="".join(BALL.format(x=x) for x in PLACES),
    )
    return mujoco_impact.attach(xml).compile()


def shot(model, data):
    """The first ball comes in; returns how many trees slept on the way, and the end."""
    mujoco.mj_resetData(model, data)
    data.qvel[0] = 1.0
    asleep = 0
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        asleep = max(asleep, model.ntree - data.ntree_awake)
    return asleep, data.qpos.copy(), data.qvel.copy()


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_sleeping_ball_takes_over_all_of_the_momentum(integrator):
    model = scene(integrator)
    asleep, qpos, qvel = shot(model, mujoco.MjData(model))
    assert asleep == 2
    _, awake_qpos, awake_qvel = shot(
        scene(integrator, sleep=False), mujoco.MjData(model)
    )
    # equal balls hand the velocity on; rounding of positions of 0.1 m
    np.testing.assert_allclose(qvel[::2], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(qvel, awake_qvel, atol=1e-12)
    np.testing.assert_allclose(qpos, awake_qpos, atol=1e-12)


def test_what_the_memory_held_before_makes_no_difference():
    """MuJoCo computes nothing for what sleeps, and leaves in arrays what was there."""
    model = scene("Euler")
    fresh = shot(model, mujoco.MjData(model))
    used = mujoco.MjData(model)
    random = np.random.default_rng(1)
    for _ in range(3):
        used.qvel[:] = 10 * random.normal(size=model.nv)
        mujoco.mj_step(model, used, 30)
        for before, after in zip(fresh, shot(model, used), strict=True):
            np.testing.assert_array_equal(before, after)
