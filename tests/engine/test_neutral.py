"""What is not ours stays MuJoCo's, bit for bit."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, header, with_integrator

import mujoco_impact
from mujoco_impact.scene import detach

# A marble that rolls and bounces on a floor, beside two balls that never meet.
SCENE = """
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <body pos="0 0 .3">
      <freejoint/>
      <geom name="box" type="box" size=".03 .04 .05" euler="10 20 30"/>
    </body>
    <body pos=".5 0 1">
      <joint type="hinge" axis="0 1 0" damping=".01"/>
      <geom name="left" size=".02" pos="0 0 -.3"/>
    </body>
    <body pos=".7 0 1">
      <joint type="hinge" axis="0 1 0"/>
      <geom name="right" size=".02" pos="0 0 -.3"/>
    </body>
  </worldbody>
</mujoco>
"""
OWNED = ["left", "right"]


def motion(spec, steps=600):
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[3:6] = 1, 2, 3
    data.qvel[6:] = 0.3, -0.2
    states = []
    for _ in range(steps):
        mujoco.mj_step(model, data)
        states.append(np.concatenate([data.qpos, data.qvel, data.qacc]))
    return model, data, np.array(states)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_without_an_impact_of_ours_every_bit_is_stock_mujoco(integrator):
    stock = with_integrator(SCENE, integrator, 0.002)
    _, _, expected = motion(stock)
    model, data, states = motion(mujoco_impact.attach(stock, geoms=OWNED))
    assert model.nplugin == 1
    assert header(model, data).count == 0
    np.testing.assert_array_equal(states, expected)
    # the scene does have contacts, and they are MuJoCo's
    assert np.ptp(states[:, 2]) > 0.1
    assert data.ncon > 0


def test_contacts_within_reach_that_never_close_change_nothing():
    """Seen, counted, and left alone."""
    stock = with_integrator(SCENE, "Euler", 0.002)
    _, _, expected = motion(stock)
    attached = mujoco_impact.attach(stock, geoms=OWNED, gap=0.2)
    model, data, states = motion(attached)
    assert any(contact.exclude == 1 for contact in data.contact)
    assert header(model, data).count == 0
    np.testing.assert_array_equal(states, expected)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_detached_scene_is_the_stock_scene(integrator):
    stock = with_integrator(SCENE, integrator, 0.002)
    _, _, expected = motion(stock)
    back = detach(mujoco_impact.attach(stock))
    model, _, states = motion(back)
    assert model.nplugin == 0
    np.testing.assert_array_equal(states, expected)


def test_the_same_scene_with_every_contact_ours_is_not_stock():
    """The comparison would notice a difference."""
    stock = with_integrator(SCENE, "Euler", 0.002)
    _, _, expected = motion(stock)
    model, data, states = motion(mujoco_impact.attach(stock))
    assert header(model, data).count > 0
    assert not np.array_equal(states, expected)
