"""Pulses over many steps turn with balls that slide on, and keep the energy."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact

RADIUS, MASS = 0.01, 0.1

SCENE = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>{balls}</worldbody>
</mujoco>
"""


def shot(places, velocities, integrator="Euler", steps=150, **settings):
    """Free balls; returns model, and velocities (steps + 1, n, 3)."""
    balls = "".join(
        f'<body pos="{x} {y} {z}"><freejoint/>'
        f'<geom size="{RADIUS}" mass="{MASS}"/></body>'
        for x, y, z in places
    )
    xml = SCENE.format(balls=balls, integrator=integrator)
    model = mujoco_impact.attach(
        xml, depth=0.5 * RADIUS, **settings, friction="none"
    ).compile()
    data = mujoco.MjData(model)
    qvel = data.qvel.reshape(len(places), 6)
    qvel[:, :3] = velocities
    path = [qvel[:, :3].copy()]
    for _ in range(steps):
        mujoco.mj_step(model, data)
        path.append(qvel[:, :3].copy())
    return np.array(path)


def kinetic(velocity):
    return 0.5 * MASS * np.sum(velocity**2, axis=(-1, -2))


# one ball meets another off its centre; both go on, the line of centres turns by
# half a radian while the pulse of 25 steps lasts
OBLIQUE = [(-0.021, 0.008, 0), (0, 0, 0)], [(0.3, 0, 0), (0, 0, 0)]


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_an_oblique_elastic_pulse_keeps_the_energy(integrator):
    path = shot(*OBLIQUE, integrator, duration=0.025)
    # the pulse did something, over many steps
    assert np.sum(kinetic(path) < 0.9 * kinetic(path[0])) > 5
    # rounding
    assert kinetic(path[-1]) == pytest.approx(kinetic(path[0]), rel=1e-13)
    np.testing.assert_allclose(path[-1].sum(axis=0), [0.3, 0, 0], atol=1e-15)


@pytest.mark.parametrize("restitution", [0.3, 0.8])
def test_an_oblique_pulse_loses_no_less_than_restitution_asks(restitution):
    path = shot(*OBLIQUE, duration=0.025, restitution=restitution)
    # where they touch the centres are 0.02 apart, 0.008 of it across the way
    closing = 0.3 * np.sqrt(1 - (0.008 / (2 * RADIUS)) ** 2)
    loss = 0.5 * (MASS / 2) * (1 - restitution**2) * closing**2
    left = kinetic(path[0]) - loss
    assert kinetic(path[-1]) <= left * (1 + 1e-12)
    # turning takes more, but no more than the part 1 − e² of what it goes through
    assert kinetic(path[-1]) >= left - 0.1 * loss


@pytest.mark.parametrize("count", [3, 4, 7])
def test_a_ring_keeps_the_energy(count):
    """Pulses of all neighbours overlap in time and turn against each other."""
    angle = 2 * np.pi * np.arange(count) / count
    around = RADIUS / np.sin(np.pi / count)
    places = around * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    velocities = np.zeros((count, 3))
    velocities[0] = [-0.2, 0.3, 0]
    path = shot(places, velocities, duration=0.02)
    assert np.any(kinetic(path) < 0.95 * kinetic(path[0]))
    # never more than at the start, and all of it in the end
    assert kinetic(path).max() <= kinetic(path[0]) * (1 + 1e-12)
    assert kinetic(path[-1]) == pytest.approx(kinetic(path[0]), rel=1e-12)
    np.testing.assert_allclose(path[-1].sum(axis=0), velocities[0], atol=1e-15)


def test_a_pulse_that_does_not_turn_is_left_as_it_is():
    path = shot([(-0.021, 0, 0), (0, 0, 0)], [(0.3, 0, 0), (0, 0, 0)], duration=0.025)
    np.testing.assert_allclose(path[-1], [[0, 0, 0], [0.3, 0, 0]], atol=1e-15)
