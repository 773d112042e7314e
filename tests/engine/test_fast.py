"""Balls that fly farther than their own size in a step are not missed."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, free_row, header

RADIUS = 0.015
SPEED = 500.0
TIMESTEP = 0.01  # 5 m a step: more than three hundred radii
# seen from as far as the ball flies in a step
SIGHT = {"radius": RADIUS, "speed": SPEED, "timestep": TIMESTEP, "gap": 10.0}


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("start", [0.1, 0.37, 0.5, 0.83])
def test_an_impact_within_one_step_is_found_behind_any_distance(integrator, start):
    model, data = free_row(
        (0.1, 0.1), start=start * SPEED * TIMESTEP, integrator=integrator, **SIGHT
    )
    mujoco.mj_step(model, data)
    assert header(model, data).count == 1
    # equal masses exchange velocities; rounding of a distance of 300 radii
    np.testing.assert_allclose(data.qvel[[0, 6]], [0, SPEED], atol=1e-9 * SPEED)
    # The struck ball stands where the time that is left has brought it. At 500 m/s the
    # contact is 6 mm deep, and the two balls go halves of the way while it lasts.
    duration = header(model, data).pulses[0, 6]
    expected = 2 * RADIUS + ((1 - start) * TIMESTEP - duration / 2) * SPEED
    assert data.qpos[7] == pytest.approx(expected, rel=1e-9)


def test_an_oblique_impact_within_one_step_has_the_normal_of_its_moment():
    """Passing at half the sum of radii: the line of centres is at 30 degrees."""
    model, data = free_row((0.1, 0.1), start=1.0, **SIGHT)
    data.qpos[1] = RADIUS
    mujoco.mj_step(model, data)
    assert header(model, data).count == 1
    normal = np.array([np.sqrt(0.75), -0.5, 0])
    along = SPEED * normal[0]
    np.testing.assert_allclose(data.qvel[6:9], along * normal, atol=1e-8 * SPEED)


def test_a_ball_that_passes_by_within_one_step_meets_nothing():
    model, data = free_row((0.1, 0.1), start=1.0, **SIGHT)
    data.qpos[1] = 2.01 * RADIUS
    mujoco.mj_step(model, data)
    assert header(model, data).count == 0
    assert data.qvel[0] == SPEED
