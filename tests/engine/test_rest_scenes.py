"""What rests or creeps under MuJoCo alone does so with the plugin on all of it."""

import math

import mujoco
import numpy as np
import pytest
from scenes import header, with_integrator

import mujoco_impact

SLOPE = 20.0
"""Of the incline [deg]: below the friction angle of .5, which is 27 degrees."""

SCENE = """
<mujoco>
  <default><geom friction=".5"/></default>
  <worldbody><geom type="plane" size="5 5 .1" euler="0 {slope} 0"/>{bodies}</worldbody>
</mujoco>
"""

BALL = '<geom size=".02"/>'
BOX = '<geom type="box" size=".05 .05 .05"/>'


def bodies(geom: str, heights: list[float], slope: float = 0.0) -> str:
    """Bodies above a plane that slopes down along x, at these heights over it [m]."""
    x, z = math.sin(math.radians(slope)), math.cos(math.radians(slope))
    return SCENE.format(
        slope=slope,
        bodies="".join(
            f'<body pos="{height * x!r} 0 {height * z!r}" euler="0 {slope} 0">'
            f"<freejoint/>{geom}</body>"
            for height in heights
        ),
    )


STACK = [0.05 + 0.1 * k for k in range(5)]

LAID = {
    "ball": bodies(BALL, [0.02]),
    "box": bodies(BOX, [0.05]),
    "stack of five": bodies(BOX, STACK),
    "incline": bodies(BOX, [0.05], SLOPE),
}


def last(model: mujoco.MjModel, seconds: float) -> tuple[np.ndarray, float, int]:
    """Returns how bodies moved [m], their speed, and the impacts after a second."""
    data = mujoco.MjData(model)
    start = data.qpos.reshape(-1, 7)[:, :3].copy()
    count = 0
    for span in (1.0, seconds - 1.0):
        before = count
        mujoco.mj_step(model, data, round(span / model.opt.timestep))
        count = header(model, data).count if model.nplugin else 0
    moved = data.qpos.reshape(-1, 7)[:, :3] - start
    return moved, float(np.abs(data.qvel).max()), count - before


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
@pytest.mark.parametrize("scene", LAID)
def test_a_minute_of_rest_is_that_of_mujoco(scene, integrator):
    spec = with_integrator(LAID[scene], integrator, 2e-3)
    alone, own_speed, _ = last(spec.compile(), 60.0)
    ours, speed, impacts = last(mujoco_impact.attach(spec).compile(), 60.0)
    assert impacts == 0
    # a micrometre over five boxes of a depth of .1 um each
    np.testing.assert_allclose(ours[:, 2], alone[:, 2], rtol=0, atol=1e-6)
    # what creeps does so by its friction and by the rounding of MuJoCo's solver, under
    # implicitfast .16 mm of the stack alone
    assert np.all(np.abs(ours[:, :2]) < 1.01 * np.abs(alone[:, :2]).max() + 1e-6)
    assert speed < max(1e-8, 2 * own_speed)


def test_a_box_creeps_down_a_slope_as_far_as_under_mujoco():
    """By a decimetre in a minute: no less, either."""
    spec = mujoco.MjSpec.from_string(LAID["incline"])
    alone, _, _ = last(spec.compile(), 60.0)
    ours, _, _ = last(mujoco_impact.attach(spec).compile(), 60.0)
    assert alone[0, 0] > 0.1
    np.testing.assert_allclose(ours[0, 0], alone[0, 0], rtol=0.01)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
@pytest.mark.parametrize(
    ("scene", "fall"), [("ball", 0.05), ("box", 0.05), ("stack of five", 0.02)]
)
def test_what_is_dropped_comes_to_rest_there_within_seconds(scene, fall, integrator):
    spec = with_integrator(LAID[scene], integrator, 2e-3)
    alone, _, _ = last(spec.compile(), 2.0)
    model = mujoco_impact.attach(spec, restitution=0.5).compile()
    data = mujoco.MjData(model)
    laid = data.qpos[2::7].copy()
    # the topmost
    data.qpos[-5] += fall
    mujoco.mj_step(model, data, 1500)
    impacts = header(model, data).count
    # its bounces are shorter by half each time, and rest once they are below a step
    assert impacts >= 3
    mujoco.mj_step(model, data, 500)
    assert header(model, data).count == impacts
    np.testing.assert_allclose(data.qpos[2::7] - laid, alone[:, 2], rtol=0, atol=1e-6)
    assert np.abs(data.qvel).max() < 1e-6
