"""What single steps cost: their distribution, and ours over the floor.

The floor is the same scene with the same margins and gaps, so that MuJoCo detects the
same contacts, without the plugin. Both make single steps from the very same states,
those of our own motion, so that they see the same contacts. Calls that make no step
are timed as well, and their median is taken off; of several rounds the fastest time of
each step counts, since the motion is the same every time and only disturbances differ.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from mujoco_impact.runner import initial_data, load_model, step_count
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.library import library_obstacle
from mujoco_impact_lab.bench.simulate import START
from mujoco_impact_lab.bench.step_cases import StepCase, step_cases

TURN = 50
"""Steps of one model, before the other one has its turn."""

MICROSECOND = 1e-6


@dataclasses.dataclass(frozen=True)
class StepTimes:
    """Times of the single steps of one motion at 2 ms, in microseconds.

    Attributes:
        case: What was stepped.
        balls: Number of balls.
        steps: Number of steps.
        mean: Mean of ours.
        p50: Median of ours.
        p99: 99th percentile of ours.
        worst: The longest step of ours.
        disturbed: The longest single measurement of ours, disturbances included.
        floor: Mean of the floor.
        ratio: Mean of ours over mean of the floor.
        per_ball: Mean of ours for each ball.
        floor_per_ball: Mean of the floor for each ball.
    """

    case: str
    balls: int
    steps: int
    mean: float
    p50: float
    p99: float
    worst: float
    disturbed: float
    floor: float
    ratio: float
    per_ball: float
    floor_per_ball: float


def step_times(
    *,
    duration: float = 20.0,
    repeats: int = 9,
    cases: Sequence[StepCase] | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[StepTimes, ...]:
    """Times single steps of swinging rows, and of rows with nothing to do.

    Args:
        duration: Simulated time of each motion [s], unless the case is shorter.
        repeats: Rounds, more of short motions; the fastest time of each step counts.
        cases: What to step; None: everything that can be had.
        progress: Called with each case as it begins.
    """
    report = progress or (lambda _: None)
    if cases is None:
        cases = step_cases(library=not library_obstacle())
    results = list[StepTimes]()
    for case in cases:
        report(f"steps of {case.title}")
        seconds = min(duration, case.longest)
        ours, floor = _timed_motion(case, seconds, repeats * case.rounds)
        results.append(_summary(case, ours, floor))
    return tuple(results)


def _timed_motion(case: StepCase, duration: float, repeats: int) -> tuple[Array, Array]:
    """Returns times of every step of ours and of the floor [s], (repeats, steps).

    But for the first one, in which memory is touched for the first time.
    """
    ours, floor = map(load_model, case.specs())
    states = _motion(ours, step_count(ours, duration))
    rounds = [_timed_round((ours, floor), states) for _ in range(repeats)]
    times = np.array(rounds)[:, :, 1:]
    return times[:, 0], times[:, 1]


def _timed_round(
    models: tuple[mujoco.MjModel, mujoco.MjModel], states: tuple[Array, Array]
) -> Array:
    """Returns times of the step from each state for both models [s], (2, steps).

    They take turns of a few steps, so that both see the same disturbances.
    """
    runs = [(model, initial_data(model, keyframe=START)) for model in models]
    count = len(states[0])
    times = np.zeros((len(models), count))
    for begin in range(0, count, TURN):
        turn = slice(begin, begin + TURN)
        for mine, (model, data) in zip(times, runs, strict=True):
            mine[turn] = _step_all(model, data, states[0][turn], states[1][turn])
    return times


def _motion(model: mujoco.MjModel, steps: int) -> tuple[Array, Array]:
    """Returns positions and velocities before each step."""
    data = initial_data(model, keyframe=START)
    positions, velocities = np.zeros((steps, model.nq)), np.zeros((steps, model.nv))
    for step in range(steps):
        positions[step], velocities[step] = data.qpos, data.qvel
        mujoco.mj_step(model, data)
    return positions, velocities


def _step_all(
    model: mujoco.MjModel, data: mujoco.MjData, positions: Array, velocities: Array
) -> Array:
    """Returns the time of the step from each state [s].

    For the model that made the motion, writing a state changes nothing.
    """
    clock, step = time.perf_counter, mujoco.mj_step
    times, calls = np.zeros(len(positions)), np.zeros(len(positions))
    for index, (qpos, qvel) in enumerate(zip(positions, velocities, strict=True)):
        data.qpos[:], data.qvel[:] = qpos, qvel
        begin = clock()
        step(model, data, nstep=0)
        called = clock()
        step(model, data, nstep=1)
        times[index] = clock() - called
        calls[index] = called - begin
    return times - float(np.median(calls))


def _summary(case: StepCase, ours: Array, floor: Array) -> StepTimes:
    """Returns the numbers of one motion, from times of shape (repeats, steps) [s]."""
    best = ours.min(axis=0) / MICROSECOND
    lowest = floor.min(axis=0) / MICROSECOND
    return StepTimes(
        case=case.title,
        balls=case.balls,
        steps=len(best),
        mean=float(best.mean()),
        p50=float(np.percentile(best, 50)),
        p99=float(np.percentile(best, 99)),
        worst=float(best.max()),
        disturbed=float(ours.max() / MICROSECOND),
        floor=float(lowest.mean()),
        ratio=float(best.mean() / lowest.mean()),
        per_ball=float(best.mean() / case.balls),
        floor_per_ball=float(lowest.mean() / case.balls),
    )
