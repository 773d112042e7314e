"""The viewer shows the forces of pulses as arrows."""

import mujoco
import pytest
from scenes import pendulums, step_to_impact


def arrows(model, data, *, shown=True):
    """The arrows that a renderer or viewer would draw now."""
    option = mujoco.MjvOption()
    option.flags[mujoco.mjtVisFlag.mjVIS_CONTACTFORCE] = shown
    scene = mujoco.MjvScene(model, maxgeom=1000)
    mujoco.mjv_updateScene(
        model,
        data,
        option,
        mujoco.MjvPerturb(),
        mujoco.MjvCamera(),
        mujoco.mjtCatBit.mjCAT_ALL,
        scene,
    )
    return [
        geom
        for geom in scene.geoms[: scene.ngeom]
        if geom.type == mujoco.mjtGeom.mjGEOM_ARROW
    ]


@pytest.mark.parametrize("shown", [True, False])
def test_pulses_are_drawn_when_contact_forces_are_shown(shown):
    """The forces of the step to come, after mj_forward."""
    model, data = pendulums("AAA", duration=7.5e-3)
    step_to_impact(model, data)
    mujoco.mj_forward(model, data)
    # two contacts share the pulse of the first impact; nothing else draws arrows
    assert len(arrows(model, data, shown=shown)) == (2 if shown else 0)


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_the_usual_loop_shows_the_step_that_was_taken(integrator):
    """mj_step and then the picture; a pulse shorter than a step is seen once."""
    model, data = pendulums("AAA", integrator=integrator)
    assert not arrows(model, data)
    step_to_impact(model, data)
    assert len(arrows(model, data)) == 2
    mujoco.mj_step(model, data)
    assert not arrows(model, data)


def test_a_long_pulse_is_seen_in_every_step_that_it_acts_in():
    """7.5 ms reach into four or five steps of 2 ms."""
    model, data = pendulums("AAA", duration=7.5e-3)
    step_to_impact(model, data)
    seen = 0
    while arrows(model, data):
        seen += 1
        mujoco.mj_step(model, data)
    assert seen in (4, 5)
