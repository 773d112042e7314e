"""No integrator, cone or dimension of MuJoCo's contacts adds energy to a bounce."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact

RADIUS, FRICTIONS = 0.02, (1, 3, 4, 6)

SCENE = """
<mujoco>
  <option timestep="0.002" integrator="{integrator}" cone="{cone}"
          jacobian="{jacobian}">
    <flag energy="enable"/>
  </option>
  <worldbody>
    <geom name="floor" type="plane" size="3 3 1" condim="1"/>
    {balls}
  </worldbody>
</mujoco>
"""


def drops(**options) -> mujoco.MjModel:
    """Balls that fall from several heights, so that stages of a step find each deep."""
    balls = "".join(
        f'<body pos="{0.1 * i} 0 {RADIUS + 0.1 + 0.03 * i}"><freejoint/>'
        f'<geom size="{RADIUS}" mass=".1" condim="{condim}"/></body>'
        for i, condim in enumerate(FRICTIONS)
    )
    xml = SCENE.format(balls=balls, **options)
    # 1 µm, which every ball passes through in the stages of its impact
    return mujoco_impact.attach(xml, restitution=0.5, depth=1e-6).compile()


@pytest.mark.parametrize("jacobian", ["dense", "sparse"])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_balls_that_are_dropped_gain_no_energy(integrator, cone, jacobian):
    """Each has a contact of another dimension: 1, 3, 4 and 6."""
    model = drops(integrator=integrator, cone=cone, jacobian=jacobian)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start = data.energy.sum()
    largest = 0.0
    for _ in range(160):
        mujoco.mj_step(model, data)
        largest = max(largest, data.energy.sum() / start)
    assert np.all(data.qvel.reshape(-1, 6)[:, :2] == 0)  # straight down and up
    # semi-implicit steps see the energy off by m g h v/2: 1e-2 of it
    assert largest <= 1.01
    assert not data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number
    # all of them have bounced: .5² of the potential energy, that of the radius aside
    assert data.energy.sum() < 0.5 * start
