"""Measuring what a simulation costs."""

from __future__ import annotations

import time
from collections.abc import Sequence

import mujoco
import numpy as np

from mujoco_impact.runner import collected_warnings
from mujoco_impact.trajectory import Array


def interleaved_times(
    models: Sequence[mujoco.MjModel],
    starts: Sequence[mujoco.MjData],
    steps: Sequence[int],
    *,
    repeats: int,
) -> Array:
    """Times simulations in turn, so that all of them see the same load of the machine.

    Each is stepped by one call into MuJoCo, without Python in between, from its initial
    state.

    Args:
        models: The models.
        starts: Initial state of each; not changed.
        steps: Number of steps of each.
        repeats: Number of rounds; one more, which is not counted, warms up.

    Returns:
        Wall-clock times [s], shape (repeats, len(models)).
    """
    if repeats < 1:
        msg = f"repeats = {repeats}: must be >= 1"
        raise ValueError(msg)
    work = [mujoco.MjData(model) for model in models]
    times = np.zeros((repeats + 1, len(models)))
    with collected_warnings():
        for turn in range(repeats + 1):
            for index, model in enumerate(models):
                mujoco.mj_copyData(work[index], model, starts[index])
                begin = time.perf_counter()
                mujoco.mj_step(model, work[index], nstep=steps[index])
                times[turn, index] = time.perf_counter() - begin
    return times[1:]
