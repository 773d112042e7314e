"""States that come from elsewhere: other models, resets, recompiled scenes."""

import mujoco
import numpy as np
import pytest
from pulse_scenes import finite, in_mid_pulse, momentum, row

from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.pulses import LAYOUT_VERSION

FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS


def state_of(model, data) -> np.ndarray:
    state = np.empty(mujoco.mj_stateSize(model, FULL))
    mujoco.mj_getState(model, data, state, FULL)
    return state


def test_a_state_of_another_model_of_the_same_size_is_reset_with_a_warning():
    """Its pulses are between geoms that this model does not have."""
    other = row(decoration='<geom size="1" contype="0" conaffinity="0"/>' * 9).compile()
    model = row().compile()
    assert other.npluginstate == model.npluginstate
    state = state_of(other, in_mid_pulse(other))
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, state, FULL)
    before = momentum(model, data)
    with collected_warnings() as messages:
        mujoco.mj_step(model, data)
    assert any("that of another model" in text for text in messages)
    # What was delivered before stays. The rest of each pulse is lost on both sides, and
    # what still closes is an impact of its own.
    assert momentum(model, data) == pytest.approx(before, rel=1e-14)


def test_a_state_of_another_size_is_refused_by_mujoco():
    bigger = row(decoration='<body><joint/><geom name="more"/></body>').compile()
    model = row().compile()
    state = state_of(bigger, mujoco.MjData(bigger))
    with pytest.raises(TypeError, match="state size"):
        mujoco.mj_setState(model, mujoco.MjData(model), state, FULL)


def test_a_state_of_zeros_begins_anew_without_a_warning(mid_pulse):
    model, data = mid_pulse
    data.plugin_state[:] = 0
    with collected_warnings() as messages:
        mujoco.mj_step(model, data)
    assert not messages
    assert data.plugin_state[0] == LAYOUT_VERSION
    assert finite(data)


def test_a_reset_in_mid_pulse_leaves_nothing_of_it(mid_pulse):
    model, data = mid_pulse
    mujoco.mj_resetData(model, data)
    fresh = mujoco.MjData(model)
    np.testing.assert_array_equal(state_of(model, data), state_of(model, fresh))
    for simulation in (data, fresh):
        simulation.qvel[0] = 0.1
        for _ in range(60):
            mujoco.mj_step(model, simulation)
    np.testing.assert_array_equal(state_of(model, data), state_of(model, fresh))
    assert fresh.plugin_state[1] > 0


def test_a_removed_body_is_named_when_the_scene_is_compiled_again():
    """The tuple still lists its geom, and MuJoCo 3 says so; MuJoCo 4 drops the tuple.

    Without the tuple the instance owns every geom, those that are left among them.
    """
    spec = row()
    spec.compile()
    spec.delete(spec.geom("three").parent)
    if mujoco.mj_versionString().startswith("3."):
        with pytest.raises(ValueError, match="'three' in tuple"):
            spec.compile()
    else:
        model = spec.compile()
        assert model.ntuple == 0
        before = momentum(model, data := in_mid_pulse(model))
        with collected_warnings():
            mujoco.mj_step(model, data, 20)
        np.testing.assert_allclose(momentum(model, data), before, rtol=1e-12)


def test_a_scene_recompiled_without_a_body_goes_on():
    spec = row()
    model = spec.compile()
    data = in_mid_pulse(model)
    spec.delete(spec.geom("three").parent)
    for element in spec.tuples:
        element.objname = ["one", "two"]
        element.objtype = [mujoco.mjtObj.mjOBJ_GEOM] * 2
        element.objprm = [0.0] * 2
    with collected_warnings():
        model, data = spec.recompile(model, data)
        before = momentum(model, data)
        for _ in range(20):
            mujoco.mj_step(model, data)
    assert finite(data)
    assert momentum(model, data) == pytest.approx(before, rel=1e-12)
