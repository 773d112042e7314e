"""Several instances of the plugin in one scene."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact

TWO_BALLS = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0" integrator="{integrator}"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
  <worldbody>
    <body><joint/><geom name="a"/></body>
    <body pos=".0205 0 0"><joint/><geom name="b"/></body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("duration", ["hertz", 5e-3])
def test_a_contact_between_geoms_of_two_instances_is_resolved_once(
    integrator, duration
):
    scene = TWO_BALLS.format(integrator=integrator)
    options = {"duration": duration, "depth": 0.004}
    scene = mujoco_impact.attach(scene, geoms=["a"], name="one", **options)
    scene = mujoco_impact.attach(scene, geoms=["b"], name="two", **options)
    motion = mujoco_impact.run(scene, duration=0.02, qvel=[1.0, 0.0])
    assert len(motion.impacts) == 1
    # equal masses exchange velocities; 1e-12 is rounding
    np.testing.assert_allclose(motion.qvel[-1], [0, 1], atol=1e-12)


def test_the_first_instance_is_the_one_that_reports_it():
    scene = mujoco_impact.attach(
        TWO_BALLS.format(integrator="Euler"), geoms=["a"], name="one"
    )
    model = mujoco_impact.attach(scene, geoms=["b"], name="two").compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    for _ in range(3):
        mujoco.mj_step(model, data)
    first, second = data.sensor("one").data, data.sensor("two").data
    assert first[6] == 1
    assert not second.any()
