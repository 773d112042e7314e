"""Warnings come to the one whose simulation gave them, whatever else runs."""

import threading

import mujoco
import numpy as np

from mujoco_impact.mujoco_warnings import collected_warnings

BALL = """
<mujoco><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>
"""


def diverge(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    data.qvel[:] = np.nan
    mujoco.mj_step(model, data)


def test_threads_collect_their_own_warnings_in_any_order_of_ending():
    model = mujoco.MjModel.from_xml_string(BALL)
    before = mujoco.get_mju_user_warning()
    begun, ended = threading.Event(), threading.Event()
    other: list[str] = []

    def collect_longer():
        with collected_warnings() as messages:
            begun.set()
            ended.wait()
            other.extend(messages)
            diverge(model)
            other.extend(f"late: {message}" for message in messages)

    thread = threading.Thread(target=collect_longer)
    with collected_warnings() as messages:
        thread.start()
        begun.wait()
        diverge(model)
        assert len(messages) == 1
    ended.set()
    thread.join()
    # nothing of this thread, and its own after this thread had left
    assert len(other) == 1
    assert other[0].startswith("late:")
    assert mujoco.get_mju_user_warning() is before


def test_the_inner_of_two_collects():
    model = mujoco.MjModel.from_xml_string(BALL)
    with collected_warnings() as outer:
        with collected_warnings() as inner:
            diverge(model)
        assert len(inner) == 1
        assert not outer
        diverge(model)
    assert len(outer) == 1
