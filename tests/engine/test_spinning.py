"""Impacts of bodies that spin: gyroscopic forces change in the middle of a step."""

import numpy as np
import pytest

import mujoco_impact

SCENE = """
<mujoco>
  <option timestep="0.002" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body pos="0 0 .1"><freejoint/>
      <geom type="{shape}" size=".05 .03 .02" density="1000"/></body>
  </worldbody>
</mujoco>
"""


def energy_of_the_first_impact(integrator, shape, seed):
    """Its change of energy, over the energy; None if a second one follows at once.

    What free flight changes in the steps before and after is taken out.
    """
    scene = SCENE.format(integrator=integrator, shape=shape)
    spin = np.random.default_rng(seed).normal(size=3) * 20
    motion = mujoco_impact.run(
        mujoco_impact.attach(scene, gap=0.05), duration=0.06, qvel=[0, 0, -2, *spin]
    )
    if not motion.impacts:
        return None
    first = motion.impacts[0].time
    if any(0 < impact.time - first < 0.006 for impact in motion.impacts):
        return None
    energy = motion.energy[:, 1]
    step = int(first / motion.timestep)
    # a pulse that the end of the step cuts reaches into the next
    steps = np.diff(energy[step - 1 : step + 4])
    return (steps[1] + steps[2] - steps[0] - steps[3]) / energy[0]


@pytest.mark.filterwarnings("ignore:energy grew")
@pytest.mark.parametrize("shape", ["box", "ellipsoid"])
@pytest.mark.parametrize(
    "integrator", ["Euler", "implicit", "implicitfast", "discrete", "RK4"]
)
def test_an_elastic_impact_of_a_spinning_body_keeps_its_energy(integrator, shape):
    """At 35 rad/s, .07 rad in a step, under every integrator."""
    found = [energy_of_the_first_impact(integrator, shape, seed) for seed in range(12)]
    changes = np.abs([change for change in found if change is not None])
    assert len(changes) >= 6
    # second order in the turn of .07 rad; measured up to 2.7e-3, RK4 9.1e-3. Before the
    # change of gyroscopic forces was counted: Euler and RK4 .015 to .024, implicit .11
    assert changes.max() < (0.012 if integrator == "RK4" else 0.005)
