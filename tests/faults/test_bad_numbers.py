"""NaN, infinity and nonsense in the state: a warning, never a crash, never silence."""

import copy

import mujoco
import numpy as np
import pytest
from pulse_scenes import active, finite, in_mid_pulse, row

import mujoco_impact
from mujoco_impact.errors import SimulationError
from mujoco_impact.mujoco_warnings import collected_warnings

BAD = (np.nan, np.inf, -np.inf, 1e300)


def steps(model, data, number: int = 50) -> list[str]:
    with collected_warnings() as messages:
        for _ in range(number):
            mujoco.mj_step(model, data)
    return messages


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("where", ["qpos", "qvel", "qfrc_applied"])
@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_a_bad_number_in_mid_pulse_makes_mujoco_warn_and_start_anew(
    where, bad, integrator
):
    model = row(option=f' integrator="{integrator}"').compile()
    data = in_mid_pulse(model)
    getattr(data, where)[1] = bad
    messages = steps(model, data)
    assert any("unstable" in text for text in messages)
    assert finite(data)
    # MuJoCo resets the data, and with it the pulses that were under way
    assert active(data) == 0


@pytest.mark.parametrize("bad", BAD)
def test_a_bad_control_leaves_a_finite_state(mid_pulse, bad):
    model, data = mid_pulse
    data.ctrl[0] = bad
    assert steps(model, data)  # MuJoCo warns of it
    assert finite(data)


@pytest.mark.parametrize("bad", BAD)
def test_a_bad_force_on_a_body_leaves_a_finite_state(mid_pulse, bad):
    model, data = mid_pulse
    data.xfrc_applied[2, 0] = bad
    assert steps(model, data)
    assert finite(data)


@pytest.mark.parametrize("bad", BAD)
def test_a_bad_time_does_not_touch_the_pulses(mid_pulse, bad):
    """Pulses live on the clock of the state."""
    model, data = mid_pulse
    sane = copy.copy(data)
    data.time = bad
    for _ in range(20):
        mujoco.mj_step(model, data)
        mujoco.mj_step(model, sane)
    np.testing.assert_array_equal(data.qvel, sane.qvel)


def test_run_turns_a_bad_start_into_an_error_with_its_time():
    with pytest.raises(SimulationError, match="QVEL") as error:
        mujoco_impact.run(row(), duration=0.1, qvel=[np.nan, 0, 0])
    assert error.value.time == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0, 3.5, 1e9, -1e300])
def test_no_damage_to_the_plugin_state_crashes(mid_pulse, bad):
    """Every number of it, one at a time."""
    model, start = mid_pulse
    with collected_warnings():
        for index in range(len(start.plugin_state)):
            data = copy.copy(start)
            data.plugin_state[index] = bad
            for _ in range(8):
                mujoco.mj_step(model, data)
            assert np.isfinite(data.qpos).all(), index


@pytest.mark.parametrize("bad", [np.nan, 1e9, -1.0])
def test_a_damaged_header_is_reset_with_a_warning(mid_pulse, bad):
    model, data = mid_pulse
    data.plugin_state[:7] = bad
    messages = steps(model, data, 1)
    assert any("plugin_state is damaged" in text for text in messages)
    assert finite(data)
