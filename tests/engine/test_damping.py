"""Joint damping that the integrator takes implicitly, however strong it is."""

import mujoco
import pytest
from scenes import header, with_integrator

import mujoco_impact
from mujoco_impact.pulses import PulseReader

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


# a ball above the floor, and a body elsewhere that it is tied to and 2 cm away from
TIED = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body pos="0 0 .012"><joint name="a" type="slide" axis="0 0 1" damping="1"/>
      <geom size=".01" mass=".001"/></body>
    <body pos="1 0 1"><joint name="b" type="slide" axis="0 0 1" damping="1"/>
      <geom size=".01" mass=".004"/></body>
  </worldbody>
  <equality><joint joint1="a" joint2="b"/></equality>
</mujoco>
"""


def falling(model: mujoco.MjModel) -> mujoco.MjData:
    """Both at 0.6 m/s downwards, the second one 2 cm too low."""
    data = mujoco.MjData(model)
    data.qvel[:], data.qpos[1] = -0.6, -0.02
    return data


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast"])
def test_a_tie_pulls_against_the_damping_until_the_impact(integrator):
    """MuJoCo sizes its pull without the damping, which then takes of it."""
    h = 0.005
    spec = with_integrator(TIED, integrator, h)
    free = spec.copy()
    free.geom("floor").contype = free.geom("floor").conaffinity = 0
    model = free.compile()
    data = falling(model)
    start = data.qvel[0]
    mujoco.mj_step(model, data)
    acceleration = (data.qvel[0] - start) / h
    model = mujoco_impact.attach(spec, restitution=0.5).compile()
    data = falling(model)
    reader = PulseReader(model, data)
    mujoco.mj_step(model, data)
    reader.poll()
    [impact] = reader.impacts
    # on the parabola of semi-implicit steps; what changes within the step is rounding
    v = start + h / 2 * acceleration
    gap = 0.002 + v * impact.time + acceleration * impact.time**2 / 2
    assert gap == pytest.approx(0, abs=1e-12)
    speed = -(v + acceleration * impact.time)
    assert impact.closing_speed == pytest.approx(speed, rel=1e-9)
