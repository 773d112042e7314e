"""The viewer shows the forces of pulses under way as arrows."""

import mujoco
import pytest
from scenes import pendulums, step_to_impact


@pytest.mark.parametrize("shown", [True, False])
def test_pulses_are_drawn_when_contact_forces_are_shown(shown):
    model, data = pendulums("AAA", duration=7.5e-3)
    step_to_impact(model, data)
    mujoco.mj_forward(model, data)
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
    arrows = [
        geom
        for geom in scene.geoms[: scene.ngeom]
        if geom.type == mujoco.mjtGeom.mjGEOM_ARROW
    ]
    # two contacts share the pulse of the first impact; nothing else draws arrows
    assert len(arrows) == (2 if shown else 0)
