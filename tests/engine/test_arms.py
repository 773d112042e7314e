"""Impacts on trees of several joints, whose inertia turns with them within the step."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from shapes import INTEGRATORS

from mujoco_impact.recorder import find_energies
from mujoco_impact.scene import attach


def chain(links: int, joint: str) -> str:
    """Capsules in a row, each on a joint at the end of the one before."""
    mjcf = ""
    for link in range(links):
        place = "0 0 1" if link == 0 else ".1 0 0"
        kind = "free" if link == 0 and joint == "free" else "ball"
        mjcf += f"""
        <body pos="{place}"><joint type="{kind}"/>
          <geom type="capsule" fromto="0 0 0 .1 0 0" size=".01"/>"""
    return mjcf + "</body>" * links


def scene(
    arm: str, *, integrator: str, timestep: float, gravity: float = 0.0
) -> mujoco.MjModel:
    """An arm, and a ball that comes down on it."""
    mjcf = f"""
    <mujoco>
      <option integrator="{integrator}" timestep="{timestep}" gravity="0 0 {-gravity}"/>
      <worldbody>{arm}
        <body pos=".155 .003 1.2"><freejoint/><geom size=".04" mass=".4"/></body>
      </worldbody>
    </mujoco>"""
    return attach(mjcf, restitution=1.0, friction="none").compile()


def thrown(model: mujoco.MjModel, *, speed: float = 4.0) -> mujoco.MjData:
    """The ball on its way down."""
    data = mujoco.MjData(model)
    data.qvel[-4] = -speed
    return data


def energy(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Of motion and height [J]."""
    copy = mujoco.MjData(model)
    copy.qpos[:], copy.qvel[:] = data.qpos, data.qvel
    find_energies(model, copy)
    return float(copy.energy.sum())


def run(model: mujoco.MjModel, data: mujoco.MjData, duration: float) -> None:
    """Steps on for a while."""
    for _ in range(round(duration / model.opt.timestep)):
        mujoco.mj_step(model, data)


@pytest.mark.parametrize("joint", ["ball", "free"])
@pytest.mark.parametrize(
    # of fourth order in the turn of a step, which is .4 rad at 4 ms
    ("timestep", "bound"),
    [(4e-3, 3e-2), (2e-3, 3e-3), (1e-3, 1e-3)],
)
def test_elastic_impacts_on_a_light_chain_keep_the_energy(joint, timestep, bound):
    """A ball on ten light links. Before, NaN at 4 ms, and more energy by half."""
    model = scene(chain(10, joint), integrator="RK4", timestep=timestep)
    data = thrown(model)
    before = energy(model, data)
    # two impacts; later MuJoCo's own contacts may push slow links, and lose energy
    run(model, data, 0.1)
    assert np.abs(data.qvel[:-6]).max() > 1.0  # the chain was struck
    assert abs(energy(model, data) / before - 1) < bound


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_no_integrator_gains_energy_from_impacts_on_a_light_chain(integrator):
    """MuJoCo's semi-implicit integrators lose some as the chain turns."""
    model = scene(chain(10, "ball"), integrator=integrator, timestep=1e-3)
    data = thrown(model)
    before = energy(model, data)
    run(model, data, 0.3)
    assert data.warning.number.sum() == 0
    # of the square of the turn
    assert energy(model, data) < 1.03 * before


def test_an_impact_keeps_the_momentum_of_a_free_chain():
    model = scene(chain(3, "free"), integrator="RK4", timestep=1e-3)
    data = thrown(model)

    def momentum() -> np.ndarray:
        copy = mujoco.MjData(model)
        copy.qpos[:], copy.qvel[:] = data.qpos, data.qvel
        mujoco.mj_forward(model, copy)
        mujoco.mj_subtreeVel(model, copy)
        return model.body_subtreemass[0] * copy.subtree_linvel[0]

    struck = 0
    for _ in range(100):
        before, velocity = momentum(), data.qvel[-4]
        mujoco.mj_step(model, data)
        if abs(data.qvel[-4] - velocity) > 1e-3:
            struck += 1
            # Runge-Kutta keeps that of what tumbles to the fourth power of its turn
            assert np.abs(momentum() - before).max() < 5e-7 * np.abs(before).max()
    assert struck > 1


@pytest.mark.parametrize(
    ("attribute", "value"),
    # most of the speed goes within a step; or much of it is turned back
    [("damping", 0.04), ("stiffness", 20.0)],
)
def test_dampers_and_springs_of_an_arm_answer_an_impact_within_its_step(
    attribute, value
):
    arm = f"""
    <body pos="0 0 1"><joint type="hinge" axis="0 1 0" {attribute}="{value}"/>
      <geom type="capsule" fromto="0 0 0 .1 0 0" size=".01"/>
      <body pos=".1 0 0"><joint type="hinge" axis="0 1 0" {attribute}="{value}"/>
        <geom type="capsule" fromto="0 0 0 .1 0 0" size=".01"/>
      </body>
    </body>"""
    model = scene(arm, integrator="RK4", timestep=2e-3)
    data = thrown(model)
    while abs(data.qvel[0]) < 1e-3:
        mujoco.mj_step(model, data)
    fine = scene(arm, integrator="RK4", timestep=2e-5)
    reference = thrown(fine)
    run(fine, reference, data.time)
    # as good as four substeps are; without an answer of the joints a tenth is missing
    error = np.abs(data.qvel[:2] - reference.qvel[:2]).max()
    assert error < 0.03 * np.abs(reference.qvel[:2]).max()


@pytest.mark.parametrize("spins", [(5.0, 3.0), (3.0, 10.0)])
def test_an_arm_leaves_an_impact_half_a_step_behind_its_path_as_euler_has_it(spins):
    """Velocities of semi-implicit integrators are those of half a step before.

    Against Runge-Kutta at a hundredth of the timestep, where the forces of the pose
    turn the impulse meanwhile. Without that, 5e-2 and 2e-2 rad/s.
    """
    xml = """
    <mujoco><option integrator="{}" timestep="{}" gravity="0 0 0"/>
      <worldbody>
        <geom name="post" size=".02" pos=".17 0 0"/>
        <body><joint axis="0 0 1"/>
          <geom type="capsule" fromto="0 0 0 .1 0 0" size=".01"/>
          <body pos=".1 0 0"><joint axis="0 0 1"/>
            <geom type="capsule" fromto="0 0 0 .1 0 0" size=".01"/></body>
        </body>
      </worldbody>
    </mujoco>"""
    h, steps, fine = 2e-3, 15, 100
    model = attach(xml.format("Euler", h), friction="none").compile()
    data = mujoco.MjData(model)
    truth = attach(xml.format("RK4", h / fine), friction="none").compile()
    true = mujoco.MjData(truth)
    for one in (data, true):
        one.qpos[:], one.qvel[:] = [-0.25, -0.095], spins
    mujoco.mj_forward(model, data)
    data.qvel -= h / 2 * data.qacc
    mujoco.mj_step(model, data, steps)
    mujoco.mj_step(truth, true, steps * fine - fine // 2)
    assert np.abs(true.qvel - spins).max() > 1.0  # it was struck
    # of Euler's second order
    np.testing.assert_allclose(data.qvel, true.qvel, atol=1e-2)
