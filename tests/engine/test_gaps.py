"""What a body strikes next does not depend on how far it flies before."""

import functools

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mujoco_impact

RADIUS, SPEED = 0.01, 0.5
MASSES = np.array([1.0, 0.01, 0.1])
"""A heavy ball sends a light one off at twice its own speed, to a third [kg]."""

STIFFNESS = 4 / 3 * 2e11 / (2 * 0.91) * np.sqrt(RADIUS / 2)

SCENE = """
<mujoco>
  <option timestep="{timestep}" gravity="0 0 0"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01"/></default>
  <worldbody>{balls}</worldbody>
</mujoco>
"""


def by_the_product(gap: float, timestep: float) -> np.ndarray:
    """Velocities when all impacts are over [m/s]."""
    xs = [-2 * RADIUS - 2e-4, 0, 2 * RADIUS + gap]
    balls = "".join(
        f'<body pos="{x!r} 0 0"><joint/><geom mass="{m}"/></body>'
        for x, m in zip(xs, MASSES, strict=True)
    )
    xml = SCENE.format(balls=balls, timestep=timestep)
    model = mujoco_impact.attach(xml, gap=0.01).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = SPEED
    mujoco.mj_step(model, data, round(0.05 / timestep))
    return data.qvel.copy()


@functools.cache
def by_integration(gap: float) -> np.ndarray:
    """The same by DOP853, of the Hertz forces."""
    start = np.array([0, 0, gap, SPEED, 0, 0])

    def rates(_, state):
        force = STIFFNESS * np.maximum(0, -np.diff(state[:3])) ** 1.5
        a = np.array([-force[0], force[0] - force[1], force[1]]) / MASSES
        return np.concatenate([state[3:], a])

    end = solve_ivp(rates, (0, 0.05), start, "DOP853", rtol=1e-9, atol=1e-12,
                    max_step=2e-5)  # fmt: skip
    return end.y[3:, -1]


@pytest.mark.parametrize("timestep", [5e-3, 1e-3])
@pytest.mark.parametrize("gap", [0, 2e-6, 1e-5, 5e-5, 1.5e-4, 4e-4, 1e-3])
def test_bodies_part_as_the_forces_say_whatever_the_gap(gap, timestep):
    # the integration of the law, and of the tail of ever smaller impacts
    error = np.abs(by_the_product(gap, timestep) - by_integration(gap))
    assert error.max() < 1e-3 * SPEED


@pytest.mark.parametrize("gap", [3.1e-5, 4.9e-5])
def test_an_impact_that_lasts_over_the_end_of_a_step_is_one(gap):
    error = np.abs(by_the_product(gap, 1e-4) - by_integration(gap))
    assert error.max() < 1e-3 * SPEED
