"""Equality constraints pass impulses on to the bodies that they tie together."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact

RADIUS, MASS = 0.01, 0.1

# the second ball is tied to a third that nothing touches
SLIDES = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0" integrator="{integrator}"
          jacobian="{jacobian}"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
  <worldbody>
    <body pos="-.03 0 0"><joint name="a"/><geom/></body>
    <body><joint name="b"/><geom/></body>
    <body pos="0 .1 0"><joint name="c"/><geom mass="{mass}"/></body>
  </worldbody>
  <equality>
    <joint joint1="b" joint2="c" polycoef="0 1 0 0 0" solimp="{stiff} {stiff} .001"/>
  </equality>
</mujoco>
"""


def run(xml, qvel, steps, **settings):
    model = mujoco_impact.attach(xml, **settings, friction="none").compile()
    data = mujoco.MjData(model)
    data.qvel[: len(qvel)] = qvel
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return data


@pytest.mark.parametrize("jacobian", ["dense", "sparse"])
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("mass", [0.1, 0.7])
def test_a_tied_ball_is_as_heavy_as_both(integrator, mass, jacobian):
    xml = SLIDES.format(
        integrator=integrator, mass=mass, jacobian=jacobian, stiff=0.9999
    )
    data = run(xml, [1.0], 40)
    both = MASS + mass
    after = (MASS - both) / (MASS + both)
    # the tie is soft by 1e-4 of the inertia
    np.testing.assert_allclose(data.qvel[0], after, atol=3e-4)
    np.testing.assert_allclose(data.qvel[1:], 1 + after, atol=3e-4)
    assert MASS * data.qvel[:2].sum() + mass * data.qvel[2] == pytest.approx(
        MASS, abs=1e-9
    )


def test_without_the_tie_it_is_not():
    xml = SLIDES.format(integrator="Euler", mass=0.7, jacobian="dense", stiff=0.9999)
    data = run(xml.replace("<joint joint1", '<joint active="false" joint1'), [1.0], 40)
    np.testing.assert_allclose(data.qvel, [0, 1, 0], atol=1e-12)


# not RK4, in whose later stages the tie pulls already
@pytest.mark.parametrize("integrator", [name for name in INTEGRATORS if name != "RK4"])
def test_a_softly_tied_ball_is_left_as_fast_as_it_was_struck(integrator):
    """The softness that the law sees is that with which MuJoCo answers in the step."""
    xml = SLIDES.format(integrator=integrator, mass=0.7, jacobian="dense", stiff=0.8)
    model = mujoco_impact.attach(xml, friction="none").compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    while data.qvel[1] == 0:
        mujoco.mj_step(model, data)
    # before the tie pulls, in the next step; to the tolerance of MuJoCo's solver
    assert data.qvel[1] - data.qvel[0] == pytest.approx(1, abs=1e-8)


def test_two_strings_as_connections_carry_a_cradle_ball():
    """A ball on two strings, closed by a `connect`, is struck like one on a hinge."""
    strings = """
<mujoco>
  <option timestep="0.001" gravity="0 0 -9.81"/>
  <default><geom type="sphere" size=".01" mass=".1"/></default>
  <worldbody>
    <body name="left" pos="0 -.05 .2">
      <joint type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 .05 -.2" size=".0005" mass="1e-5"
            contype="0" conaffinity="0"/>
      <geom name="struck" pos="0 .05 -.2"/>
    </body>
    <body name="right" pos="0 .05 .2">
      <joint type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 -.05 -.2" size=".0005" mass="{mass}"
            contype="0" conaffinity="0"/>
    </body>
    <body pos="-.03 0 0"><joint type="slide" axis="1 0 0"/><geom name="comes"/></body>
  </worldbody>
  <equality>
    <connect body1="left" body2="right" anchor="0 .05 -.2" solimp=".9999 .9999 .001"/>
  </equality>
</mujoco>
"""
    light, heavy = (
        run(strings.format(mass=mass), [0, 0, 0.5], 40, geoms=["struck", "comes"])
        for mass in (1e-5, 0.3)
    )
    # a rod of mass M about its end weighs M/3 at the other: 0.1 kg more
    assert light.qvel[2] == pytest.approx(0, abs=2e-3)
    assert heavy.qvel[2] == pytest.approx(0.5 * (0.1 - 0.2) / (0.1 + 0.2), abs=2e-2)


def test_contacts_of_tied_bodies_are_one_impact():
    """Two tied balls are struck at once, each by another: nothing is left over."""
    xml = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
  <worldbody>
    <body pos="-.03 0 0"><joint/><geom/></body>
    <body><joint name="b"/><geom/></body>
    <body pos="-.03 .1 0"><joint/><geom/></body>
    <body pos="0 .1 0"><joint name="c"/><geom/></body>
  </worldbody>
  <equality>
    <joint joint1="b" joint2="c" polycoef="0 1 0 0 0" solimp=".9999 .9999 .001"/>
  </equality>
</mujoco>
"""
    data = run(xml, [1.0, 0, 1.0, 0], 30)
    np.testing.assert_allclose(data.qvel, [0, 1, 0, 1], atol=3e-4)


def test_friction_of_a_welded_pair_is_that_of_one_body():
    """Two balls on a common rod glance off the floor. Untied, .2 m/s and 1.7 rad/s."""
    one = """
    <body pos="-.05 0 .1"><freejoint/><geom size=".03" mass=".2"/>
      <body pos=".1 0 0"><geom size=".03" mass=".3"/></body></body>"""
    two = """
    <body name="a" pos="-.05 0 .1"><freejoint/><geom size=".03" mass=".2"/></body>
    <body name="b" pos=".05 0 .1"><freejoint/><geom size=".03" mass=".3"/></body>"""
    weld = """
    <equality><weld body1="a" body2="b" solref=".004 1" solimp=".9999 .9999 .001"/>
    </equality>"""
    tilt = 0.2
    after = []
    for bodies, tie in ((one, ""), (two, weld)):
        model = mujoco_impact.attach(
            f"""
            <mujoco><option timestep=".002" gravity="0 0 0"/>
              <default><geom friction=".3"/></default>
              <worldbody><geom type="plane" size="5 5 .1"/>{bodies}</worldbody>{tie}
            </mujoco>""",
            restitution=0.8,
        ).compile()
        data = mujoco.MjData(model)
        poses = data.qpos.reshape(-1, 7)
        poses[:, 3:] = [np.cos(tilt / 2), 0, np.sin(tilt / 2), 0]
        rod = np.array([0.1 * np.cos(tilt), 0, -0.1 * np.sin(tilt)])
        poses[:, :3] = poses[0, :3] + np.outer(range(len(poses)), rod)
        data.qvel.reshape(-1, 6)[:, :3] = [0.7, 0.4, -1]
        while not data.sensordata.any():
            mujoco.mj_step(model, data)
        after.append(data.qvel[:6].copy())
    # the weld gives way a little
    np.testing.assert_allclose(after[0][:3], after[1][:3], atol=0.02)
    np.testing.assert_allclose(after[0][3:], after[1][3:], atol=0.1)
