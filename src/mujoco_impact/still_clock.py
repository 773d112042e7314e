"""Steps without MuJoCo's timers.

MuJoCo's Python package reads a clock before and after each part of a step, for
`mjData.timer`. That is a fifth of the time of a step of five balls. Simulations whose
timers nobody sees can do without.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import mujoco

from mujoco_impact._plugin import load, plugin_path


class _Clock:
    """MuJoCo's clock, which stands still as long as anyone wants it to."""

    def __init__(self) -> None:
        """Starts with a clock that runs."""
        self._lock = threading.Lock()
        self._wanted = 0
        self._running: Any = None

    def stop(self) -> None:
        """Stops the clock, for one more."""
        with self._lock:
            if self._wanted == 0:
                self._running = mujoco.get_mjcb_time()
                mujoco.set_mjcb_time(_standing())
            self._wanted += 1

    def go_on(self) -> None:
        """Lets the clock go on, for one; it does so once all let it."""
        with self._lock:
            self._wanted -= 1
            if self._wanted == 0:
                mujoco.set_mjcb_time(self._running)


_clock = _Clock()


@contextmanager
def still_clock() -> Iterator[None]:
    """Has MuJoCo's clock stand still within the block, in all threads."""
    _clock.stop()
    try:
        yield
    finally:
        _clock.go_on()


@cache
def _standing() -> Any:
    """Returns a clock that stands still, a function of the plugin library."""
    load()
    clock = ctypes.CDLL(str(plugin_path())).mujoco_impact_still_clock
    clock.restype, clock.argtypes = ctypes.c_double, []
    return clock
