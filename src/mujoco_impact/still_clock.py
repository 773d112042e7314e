"""Steps without MuJoCo's timers.

MuJoCo's Python package reads a clock before and after each part of a step, for
`mjData.timer`. That is a fifth of the time of a step of five balls. Simulations whose
timers nobody sees can do without.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import mujoco

from mujoco_impact._plugin import load, plugin_path


@contextmanager
def still_clock() -> Iterator[None]:
    """Has MuJoCo's clock stand still within the block, in all threads."""
    clock = mujoco.get_mjcb_time()
    mujoco.set_mjcb_time(_still_clock())
    try:
        yield
    finally:
        mujoco.set_mjcb_time(clock)


@cache
def _still_clock() -> Any:
    """Returns the clock, a function of the plugin library."""
    load()
    clock = ctypes.CDLL(str(plugin_path())).mujoco_impact_still_clock
    clock.restype, clock.argtypes = ctypes.c_double, []
    return clock
