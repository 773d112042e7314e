"""Switches of MuJoCo that silence the plugin, or hand contacts back, at run time.

Compiled in, they are refused (tests/engine/test_config.py, tests/api/test_attach.py).
"""

import mujoco
import pytest
from pulse_scenes import active, in_mid_pulse, momentum, row

from mujoco_impact.mujoco_warnings import collected_warnings

SPRING = mujoco.mjtDisableBit.mjDSBL_SPRING
DAMPER = mujoco.mjtDisableBit.mjDSBL_DAMPER
OVERRIDE = mujoco.mjtEnableBit.mjENBL_OVERRIDE


def step(model, data, number: int = 1) -> list[str]:
    with collected_warnings() as messages:
        for _ in range(number):
            mujoco.mj_step(model, data)
    return messages


def test_passive_forces_switched_off_are_warned_of_when_an_impact_is_missed():
    model = row().compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 0.1
    model.opt.disableflags |= SPRING | DAMPER
    messages = step(model, data, 10)
    assert any("spring and damper are both disabled" in text for text in messages)


def test_passive_forces_switched_off_away_from_impacts_are_no_matter():
    model = row().compile()
    data = mujoco.MjData(model)
    model.opt.disableflags |= SPRING | DAMPER
    assert not step(model, data, 10)


def test_data_made_with_the_switches_set_is_refused():
    model = row().compile()
    model.opt.disableflags |= SPRING | DAMPER
    with pytest.raises(mujoco.FatalError, match="init failed"):
        mujoco.MjData(model)


@pytest.mark.parametrize("flag", [SPRING, DAMPER])
def test_one_of_the_two_flags_changes_nothing(flag):
    model = row().compile()
    data = in_mid_pulse(model)
    model.opt.disableflags |= flag
    assert not step(model, data, 30)
    assert data.qvel[0] == pytest.approx(-0.0071, abs=5e-4)


def test_a_pulse_interrupted_by_the_switch_is_delivered_when_it_is_back():
    """No momentum is lost: a step delivers what is due by then."""
    model = row().compile()
    plain, interrupted = in_mid_pulse(model), in_mid_pulse(model)
    model.opt.disableflags |= SPRING | DAMPER
    step(model, interrupted)
    model.opt.disableflags &= ~(SPRING | DAMPER)
    step(model, plain)
    for data in (plain, interrupted):
        step(model, data, 30)
        assert active(data) == 0
        assert momentum(model, data) == pytest.approx(0.01, rel=1e-12)
    assert interrupted.qvel == pytest.approx(plain.qvel, abs=1e-12)


def test_override_switched_on_gives_the_contacts_to_mujoco():
    """Its solver pushes them apart; momentum is kept, restitution is MuJoCo's."""
    model = row().compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 0.1
    model.opt.enableflags |= OVERRIDE
    step(model, data, 200)
    assert data.plugin_state[1] == 0
    assert momentum(model, data) == pytest.approx(0.01, rel=1e-9)
    assert data.qpos[1] - data.qpos[0] > -0.01


def test_adhesion_switched_on_gives_the_contacts_to_mujoco():
    model = row().compile()
    model.geom_adhesion[:] = 1.0
    data = mujoco.MjData(model)
    data.qvel[0] = 0.1
    step(model, data, 200)
    assert data.plugin_state[1] == 0
    assert momentum(model, data) == pytest.approx(0.01, rel=1e-6)
