"""Plastic impacts: bodies that go on together do not collide again."""

import mujoco
import numpy as np
import pytest
from scenes import free_row, header


# of the contact time: delivered in one step, and in many
@pytest.mark.parametrize("timestep", [2e-3, 1e-6])
@pytest.mark.parametrize("duration", ["hertz", 5e-6])
def test_a_plastic_pair_has_one_impact(timestep, duration):
    model, data = free_row(
        (0.1, 0.3),
        start=1e-6,
        speed=0.7,
        restitution=0.0,
        timestep=timestep,
        duration=duration,
        # a pulse of many steps leaves them pressed by 10 µm: deeper than by the default
        # depth MuJoCo's contact would push them
        depth=1e-4,
    )
    for _ in range(300):
        mujoco.mj_step(model, data)
    assert header(model, data).count == 1
    assert header(model, data).active == 0
    # the common speed of 0.1 and 0.3 kg
    np.testing.assert_allclose(data.qvel[[0, 6]], 0.7 / 4, rtol=1e-12)
