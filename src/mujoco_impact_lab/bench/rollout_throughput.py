"""Throughput of `rollout`: simulations a second, on one thread and on several."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import cradle_models
import mujoco_impact
from mujoco_impact.trajectory import Array

BALLS = "AAAAA"

DURATION = 1.0
"""Simulated time of each rollout [s]; 500 steps."""


@dataclass(frozen=True)
class Throughput:
    """One measurement.

    Attributes:
        threads: Number of threads.
        rollouts: How many simulations of 1 s.
        seconds: Wall-clock time [s].
        processor_seconds: Processor time of all threads [s], on which other load of
            the machine has little effect.
        rollouts_per_second: Simulations a second; as many seconds are simulated.
        result: Hash of all final states, the plugin's included.
    """

    threads: int
    rollouts: int
    seconds: float
    processor_seconds: float
    rollouts_per_second: float
    result: str


def throughput(
    threads: Sequence[int],
    rollouts: int,
    progress: Callable[[float], None] | None = None,
) -> list[Throughput]:
    """Lets go the first ball of a cradle at as many angles as there are rollouts.

    Args:
        threads: Numbers of threads to measure.
        rollouts: Number of simulations for each.
        progress: Called with the finished fraction.
    """
    model = mujoco_impact.attach(cradle_models.row(BALLS)).compile()
    qpos: Array = np.zeros((rollouts, len(BALLS)))
    qpos[:, 0] = -np.linspace(0.1, 0.8, rollouts)
    steps = round(DURATION / model.opt.timestep)
    found = []
    for number, count in enumerate(threads):
        begin, processor = time.perf_counter(), time.process_time()
        ran = mujoco_impact.rollout(
            model, duration=DURATION, qpos=qpos, every=steps, threads=count
        )
        seconds = time.perf_counter() - begin
        processor = time.process_time() - processor
        found.append(
            Throughput(
                threads=count,
                rollouts=rollouts,
                seconds=round(seconds, 2),
                processor_seconds=round(processor, 2),
                rollouts_per_second=round(rollouts / seconds, 1),
                result=hashlib.sha256(ran.final_state.tobytes()).hexdigest()[:16],
            )
        )
        if progress is not None:
            progress((number + 1) / len(threads))
    return found
