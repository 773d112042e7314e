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
from collections.abc import Callable

import mujoco
import numpy as np

import cradle_models
from mujoco_impact.bench.scenes import BASE_TIMESTEP
from mujoco_impact.bench.simulate import START
from mujoco_impact.runner import initial_data, load_model, step_count
from mujoco_impact.scene import attach, detach
from mujoco_impact.source import read_spec
from mujoco_impact.trajectory import Array

BALLS = (3, 5, 50)

BEFORE_IMPACT = 0.2
"""A ball let go at 30 degrees is still far from the row [s]."""

ALONE_GAP, ALONE_RELEASE = 0.2, 10.0
"""Gap [m] and release [deg] of a row whose balls never meet."""

MICROSECOND = 1e-6


@dataclasses.dataclass(frozen=True)
class StepTimes:
    """Times of the single steps of one motion at 2 ms, in microseconds.

    Attributes:
        case: What was stepped.
        steps: Number of steps.
        mean: Mean of ours.
        p50: Median of ours.
        p99: 99th percentile of ours.
        worst: The longest step of ours.
        disturbed: The longest single measurement of ours, disturbances included.
        floor: Mean of the floor.
        ratio: Mean of ours over mean of the floor.
    """

    case: str
    steps: int
    mean: float
    p50: float
    p99: float
    worst: float
    disturbed: float
    floor: float
    ratio: float


def step_times(
    *,
    duration: float = 20.0,
    repeats: int = 5,
    progress: Callable[[str], None] | None = None,
) -> tuple[StepTimes, ...]:
    """Times single steps of swinging rows, and of rows with nothing to do.

    Args:
        duration: Simulated time of each motion [s].
        repeats: Rounds; the fastest time of each step counts.
        progress: Called with each case as it begins.
    """
    report = progress or (lambda _: None)
    results = list[StepTimes]()
    for count in BALLS:
        report(f"steps of {count} balls")
        ours, floor = _timed_motion(cradle_models.row("A" * count), duration, repeats)
        results.append(_summary(f"{count} swinging balls", ours, floor))
        quiet = round(BEFORE_IMPACT / BASE_TIMESTEP)
        if count == 5:
            still = _summary(
                "5 balls, nothing closes", ours[:, 1:quiet], floor[:, 1:quiet]
            )
    report("steps of balls that never meet")
    alone = cradle_models.row("AAAAA", gap=ALONE_GAP, release=ALONE_RELEASE)
    ours, floor = _timed_motion(alone, duration, repeats)
    results += [still, _summary("5 balls, no contact", ours, floor)]
    return tuple(results)


def _timed_motion(xml: str, duration: float, repeats: int) -> tuple[Array, Array]:
    """Returns times of every step of ours and of the floor [s], (repeats, steps)."""
    plain = read_spec(xml)
    attached = attach(plain)
    ours, floor = load_model(attached), load_model(_floor(attached))
    states = _motion(ours, step_count(ours, duration))
    rounds = [(_step_all(ours, states), _step_all(floor, states))
              for _ in range(repeats)]  # fmt: skip
    return (
        np.array([times for times, _ in rounds]),
        np.array([times for _, times in rounds]),
    )


def _floor(attached: mujoco.MjSpec) -> mujoco.MjSpec:
    """Returns a scene without the plugin, in which the same contacts are detected."""
    floor = detach(attached)
    for geom, owned in zip(floor.geoms, attached.geoms, strict=True):
        geom.margin, geom.gap = owned.margin, owned.gap
    return floor


def _motion(model: mujoco.MjModel, steps: int) -> tuple[Array, Array]:
    """Returns positions and velocities before each step."""
    data = initial_data(model, keyframe=START)
    positions, velocities = np.zeros((steps, model.nq)), np.zeros((steps, model.nv))
    for step in range(steps):
        positions[step], velocities[step] = data.qpos, data.qvel
        mujoco.mj_step(model, data)
    return positions, velocities


def _step_all(model: mujoco.MjModel, states: tuple[Array, Array]) -> Array:
    """Returns the time of the step from each state [s].

    For the model that made the motion, writing a state changes nothing.
    """
    data = initial_data(model, keyframe=START)
    clock, step = time.perf_counter, mujoco.mj_step
    times, calls = np.zeros(len(states[0])), np.zeros(len(states[0]))
    for index, (qpos, qvel) in enumerate(zip(*states, strict=True)):
        data.qpos[:], data.qvel[:] = qpos, qvel
        begin = clock()
        step(model, data, nstep=0)
        called = clock()
        step(model, data, nstep=1)
        times[index] = clock() - called
        calls[index] = called - begin
    return times - float(np.median(calls))


def _summary(case: str, ours: Array, floor: Array) -> StepTimes:
    """Returns the numbers of one motion, from times of shape (repeats, steps) [s]."""
    best = ours.min(axis=0) / MICROSECOND
    lowest = floor.min(axis=0) / MICROSECOND
    return StepTimes(
        case=case,
        steps=len(best),
        mean=float(best.mean()),
        p50=float(np.percentile(best, 50)),
        p99=float(np.percentile(best, 99)),
        worst=float(best.max()),
        disturbed=float(ours.max() / MICROSECOND),
        floor=float(lowest.mean()),
        ratio=float(best.mean() / lowest.mean()),
    )
