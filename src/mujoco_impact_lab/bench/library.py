"""The library of compiled code that the benchmark compares with.

Its sources are in `plugin/bench`; `scripts/bench` builds it.
"""

from __future__ import annotations

import ctypes
import os
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

LIBRARY_VARIABLE = "MUJOCO_IMPACT_BENCH_LIBRARY"
"""Environment variable with the path of the library."""

DOUBLES: Any = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
"""Type of an argument that is an array of numbers."""


def library_obstacle() -> str:
    """Returns why there is no library, else empty."""
    if Path(os.environ.get(LIBRARY_VARIABLE, "")).is_file():
        return ""
    return f"{LIBRARY_VARIABLE} names no library (scripts/bench builds it)"


def load_library() -> ctypes.CDLL:
    """Returns the library; it must be there, see `library_obstacle`."""
    return _load(str(library_path()))


def library_path() -> Path:
    """Returns where it is; it must be there, see `library_obstacle`."""
    return Path(os.environ[LIBRARY_VARIABLE])


@cache
def _load(path: str) -> ctypes.CDLL:
    """Returns the library, with the types of its functions."""
    library = ctypes.CDLL(path)
    number, count, long = ctypes.c_double, ctypes.c_int, ctypes.c_long
    row = [count, number, number, number]
    arguments = {
        "hertz_chain_swing": [
            count, number, *[DOUBLES] * 5, number, number, number,
            count, DOUBLES, DOUBLES,
        ],
        "impact_timing_law": [*row, number, count, DOUBLES, DOUBLES],
        "impact_timing_loop": [*row, number, long, count, DOUBLES, DOUBLES],
    }  # fmt: skip
    for name, types in arguments.items():
        function = getattr(library, name)
        function.restype = long
        function.argtypes = types
    return library
