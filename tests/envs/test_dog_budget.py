"""A dog that falls on all of its geoms at once takes no longer than a step may."""

import numpy as np
import pytest

pytest.importorskip("dm_control")

from mujoco_impact import envs

WORK = 15  # in the header of the state, over its budget: plugin/README.md


@pytest.mark.filterwarnings("ignore:MuJoCo.s sensors")
@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize(
    "options", [{}, {"depth": 1e-6}], ids=["default depth", "1 um"]
)
def test_a_dog_of_many_geoms_keeps_to_the_budget(restitution, options):
    """Hundreds of contacts of one tree of 79 degrees of freedom."""
    environment = envs.load(
        "dog", "stand", task_kwargs={"random": 0}, restitution=restitution, **options
    )
    environment.reset()
    physics = environment.physics
    model, data = physics.model, physics.data
    random = np.random.default_rng(0)
    worst = contacts = 0.0
    for step in range(60):
        if step % 15 == 0:
            physics.set_control(random.uniform(-1, 1, model.nu))
        physics.step()
        work = float(data.plugin_state[model.plugin_stateadr[0] + WORK])
        worst, contacts = max(worst, work), max(contacts, data.ncon)
    assert contacts > 100
    # the last round of a step is ended, not left out
    assert 0.02 < worst < 2.0
    assert np.all(np.isfinite(data.qpos))
