"""MuJoCo's timers stand still while anyone wants them to, and go on afterwards."""

import mujoco

from mujoco_impact.still_clock import still_clock

XML = (
    "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
)


def test_the_clock_goes_on_once_all_let_it():
    model = mujoco.MjModel.from_xml_string(XML)
    data = mujoco.MjData(model)

    def step() -> float:
        data.timer.duration[:] = 0
        mujoco.mj_step(model, data)
        return data.timer[mujoco.mjtTimer.mjTIMER_STEP].duration

    assert step() > 0
    # two that overlap, the first to begin is the first to end
    one, other = still_clock(), still_clock()
    one.__enter__()
    assert step() == 0
    other.__enter__()
    one.__exit__(None, None, None)
    assert step() == 0
    other.__exit__(None, None, None)
    assert step() > 0
