"""Joint damping that the integrator takes implicitly, however strong it is."""

import mujoco
import pytest
from scenes import header, with_integrator

import mujoco_impact

# h B / M = 50: by its explicit acceleration the ball would turn back within a step
LIGHT = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 .0101"><joint type="slide" axis="0 0 1" damping="10"/>
      <geom size=".01" mass=".001"/></body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize(
    "integrator", ["Euler", "implicit", "implicitfast", "discrete"]
)
def test_a_light_damped_body_strikes_what_it_comes_to_and_gains_no_energy(integrator):
    """It meets the floor with what damping has left of its speed."""
    spec = with_integrator(LIGHT, integrator, 0.005)
    model = mujoco_impact.attach(spec, restitution=1.0).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = -5.0
    speeds = []
    for _ in range(20):
        mujoco.mj_step(model, data)
        speeds.append(abs(data.qvel[0]))
    assert header(model, data).count > 0
    assert max(speeds) < 5.0
    assert speeds[-1] < 1e-6
    assert data.qpos[0] > -1.1e-4
