"""Everything that evolves is in plugin_state: copies and repeats change nothing."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, header, pendulums, step_to_impact

STEPS = 60


def mid_pulse(integrator="Euler", duration=7.5e-3):
    """A row of three in the middle of its first pulse."""
    model, data = pendulums("AAA", integrator=integrator, duration=duration)
    step_to_impact(model, data)
    assert header(model, data).active == 2
    return model, data


def advance(model, data, steps=STEPS):
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return np.concatenate([[data.time], data.qpos, data.qvel, data.plugin_state])


def by_copy(_, data):
    return copy.copy(data)


def by_deepcopy(_, data):
    return copy.deepcopy(data)


def by_pickle(_, data):
    return pickle.loads(pickle.dumps(data))


def by_state(model, data):
    signature = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.empty(mujoco.mj_stateSize(model, signature))
    mujoco.mj_getState(model, data, state, signature)
    fresh = mujoco.MjData(model)
    mujoco.mj_setState(model, fresh, state, signature)
    return fresh


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("duplicate", [by_copy, by_deepcopy, by_pickle, by_state])
def test_a_copy_in_mid_pulse_continues_bit_for_bit(integrator, duplicate):
    model, data = mid_pulse(integrator)
    twin = duplicate(model, data)
    np.testing.assert_array_equal(advance(model, twin), advance(model, data))


def test_a_pickled_model_continues_bit_for_bit():
    model, data = mid_pulse()
    model_twin, twin = pickle.loads(pickle.dumps((model, data)))
    np.testing.assert_array_equal(advance(model_twin, twin), advance(model, data))


def test_a_state_restored_without_its_time_continues():
    """dm_control restores positions, velocities and plugin state, but not the time."""
    model, data = mid_pulse()
    twin = by_state(model, data)
    twin.time = 77.0
    np.testing.assert_array_equal(advance(model, twin)[1:], advance(model, data)[1:])


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_forward_before_a_step_changes_nothing(integrator, duration):
    """Viewers call mj_forward at will; compute runs when no step follows."""
    model, data = pendulums("AAA", integrator=integrator, duration=duration)
    _, twin = pendulums("AAA", integrator=integrator, duration=duration)
    for _ in range(160):
        mujoco.mj_forward(model, twin)
        mujoco.mj_forward(model, twin)
        mujoco.mj_step(model, twin)
        mujoco.mj_step(model, data)
        np.testing.assert_array_equal(twin.qpos, data.qpos)
        np.testing.assert_array_equal(twin.qvel, data.qvel)
    assert header(model, data).count == header(model, twin).count > 0


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_step1_and_step2_are_a_step(integrator):
    """Under RK4 mj_step2 integrates with Euler; the correction follows."""
    model, data = pendulums("AAA", integrator=integrator)
    other, twin = pendulums(
        "AAA", integrator="Euler" if integrator == "RK4" else integrator
    )
    for _ in range(200):
        mujoco.mj_step1(model, data)
        mujoco.mj_step2(model, data)
        mujoco.mj_step(other, twin)
    assert header(model, data).count > 0
    # the path ahead is V = v under RK4 and v + h/2 a otherwise: 1e-4 of the speed
    tolerance = 2e-3 if integrator == "RK4" else 0
    np.testing.assert_allclose(data.qpos, twin.qpos, rtol=0, atol=tolerance)


def test_reset_forgets_every_pulse():
    model, data = mid_pulse()
    mujoco.mj_resetDataKeyframe(model, data, 0)
    _, fresh = pendulums("AAA", duration=7.5e-3)
    np.testing.assert_array_equal(data.plugin_state, fresh.plugin_state)
    np.testing.assert_array_equal(advance(model, data, 200), advance(model, fresh, 200))


def test_zeroed_state_mends_itself():
    model, data = pendulums("AAA")
    data.plugin_state[:] = 0
    step_to_impact(model, data)
    assert header(model, data).count == 2


def test_threads_agree_bit_for_bit():
    model, _ = pendulums("AAAAA")

    def simulate(_):
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        return advance(model, data, 400)

    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(simulate, range(8)))
    for result in results[1:]:
        np.testing.assert_array_equal(result, results[0])


def test_plugin_data_stays_null():
    """Pickling MjData copies the raw pointer, so there must be none."""
    _, data = mid_pulse()
    assert not np.any(data.plugin_data)
