"""Bodies at rest are MuJoCo's: the plugin changes nothing about how they lie."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, with_integrator

import mujoco_impact

RADIUS = 0.02


def table(count: int) -> str:
    """Balls laid on a table, out of reach of each other."""
    balls = "".join(
        f'<body pos="{0.1 * i} 0 {RADIUS}"><freejoint/>'
        f'<geom name="ball{i}" size="{RADIUS}" mass=".1"/></body>'
        for i in range(count)
    )
    return f"""
    <mujoco>
      <worldbody><geom type="plane" size="9 9 1"/>{balls}</worldbody>
    </mujoco>"""


def sinks(model: mujoco.MjModel) -> np.ndarray:
    """How deep each ball lies in the table after a second [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 500)
    assert np.abs(data.qvel).max() < 1e-6
    return RADIUS - data.qpos.reshape(-1, 7)[:, 2]


@pytest.mark.parametrize("count", [1, 16, 50])
def test_balls_on_a_table_sink_as_deep_as_without_the_plugin(count):
    alone = sinks(mujoco.MjModel.from_xml_string(table(count)))
    ours = sinks(mujoco_impact.attach(table(count), restitution=0.5).compile())
    # the default depth is 1 µm
    np.testing.assert_allclose(ours, alone, rtol=0, atol=2e-6)


@pytest.mark.parametrize("integrator", [name for name in INTEGRATORS if name != "RK4"])
def test_a_ball_that_bounced_comes_to_rest_there_too(integrator):
    spec = with_integrator(table(1), integrator, 0.002)
    alone = sinks(spec.copy().compile())
    model = mujoco_impact.attach(spec, restitution=0.5).compile()
    data = mujoco.MjData(model)
    data.qpos[2] += 0.1
    mujoco.mj_step(model, data, 1500)
    assert data.sensor("impact").data[6] >= 4
    assert np.abs(data.qvel).max() < 1e-6
    np.testing.assert_allclose(RADIUS - data.qpos[2], alone, rtol=0, atol=2e-6)
