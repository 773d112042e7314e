"""Many simulations of one model, on several threads or wherever an executor is.

A thin layer over `mujoco.rollout`: initial states by position and velocity, progress,
and only as many samples kept as asked for. The numbers are those of single steps, bit
for bit, on any number of threads and by any executor.
"""

from __future__ import annotations

import dataclasses
import math
import os
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor

import mujoco
import numpy as np
import numpy.typing as npt
from mujoco.rollout import Rollout

from mujoco_impact import _plugin
from mujoco_impact.errors import ImpactWarning, SceneError
from mujoco_impact.executors import CHUNKS, in_order
from mujoco_impact.recordings import check_recording
from mujoco_impact.rollout_parts import STATE, Part, Plan, Simulated, Simulator
from mujoco_impact.runner import Model, initial_data, load_model, step_count
from mujoco_impact.starts import Keyframe, keyframe_names, settled
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.fast_bodies import Approaches


@dataclasses.dataclass(frozen=True, eq=False)
class Rollouts:
    """N simulated motions, sampled at the same times.

    Attributes:
        time: Time of each sample [s], shape (n_samples,); the initial state is not
            among them.
        qpos: Positions, shape (N, n_samples, nq).
        qvel: Velocities, shape (N, n_samples, nv).
        sensordata: Sensors of the steps that end at the samples, shape (N, n_samples,
            nsensordata).
        final_state: `STATE` at the end, shape (N, n_state): where to go on from.
    """

    time: Array
    qpos: Array
    qvel: Array
    sensordata: Array
    final_state: Array


def rollout(
    model: Model,
    *,
    duration: float,
    qpos: npt.ArrayLike | None = None,
    qvel: npt.ArrayLike | None = None,
    keyframe: Keyframe = None,
    initial_state: npt.ArrayLike | None = None,
    control: npt.ArrayLike | None = None,
    every: int = 1,
    threads: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
) -> Rollouts:
    """Simulates a model from many initial states.

    Warns (`ImpactWarning`) of bodies that are too fast for their gap, as far as a look
    at the fastest states tells.

    Args:
        model: Compiled model (not changed), specification, path or XML text.
        duration: Simulated time [s].
        qpos: Initial positions, shape (N, nq), or (nq,) for all.
        qvel: Initial velocities, shape (N, nv), or (nv,) for all.
        keyframe: Where the rest of the initial state comes from; see `run`.
        initial_state: Whole states (`STATE`), shape (N, n_state), instead of the three
            above, for example `final_state` of rollouts to be continued.
        control: Controls, shape (N, steps, nu), or (steps, nu) for all.
        every: Steps between two samples.
        threads: Number of threads; by default one for each processor.
        executor: Where to simulate, instead of threads; see `executors.in_order`.
        progress: Called after each part with the finished fraction, 0 to 1.

    Raises:
        SceneError: If the model or an initial state is not valid.
        SimulationError: If MuJoCo gives a warning, for example on divergence.
        ValueError: If another argument is not valid.
    """
    _plugin.load()
    compiled = load_model(model)
    steps = step_count(compiled, duration)
    if executor is not None and threads is not None:
        raise ValueError(f"executor and threads = {threads}: give one of them")
    workers = thread_count(threads)
    if not 1 <= every <= steps:
        raise ValueError(f"every = {every}: must be 1 to {steps}, the number of steps")
    if initial_state is None:
        start = initial_states(compiled, qpos=qpos, qvel=qvel, keyframe=keyframe)
    else:
        start = _given_states(compiled, initial_state, (qpos, qvel, keyframe))
    controls = _controls(compiled, control, len(start), steps)
    plan = Plan(compiled, steps, every)
    rows = plan.rows_per_call(workers)
    if executor is not None:
        rows = min(plan.rows_per_call(1), math.ceil(len(start) / CHUNKS))
    check_recording(min(rows, len(start)) * steps, plan.numbers)
    check_recording(len(start) * (steps // every), plan.numbers)
    parts = _parts(start, controls, rows)
    if executor is not None:
        results = in_order(Simulator(plan), parts, executor=executor)
    else:
        results = _on_threads(plan, parts, workers)
    found = list[Simulated]()
    for part, one in zip(parts, results, strict=True):
        found.append(one)
        if progress is not None:
            progress((part.first + len(part.start)) / len(start))
    return _together(compiled, found)


def _parts(start: Array, controls: Array | None, rows: int) -> list[Part]:
    """Returns the simulations in parts of so many rows."""
    return [
        Part(
            first,
            start[first : first + rows],
            None if controls is None else controls[first : first + rows],
        )
        for first in range(0, len(start), rows)
    ]


def _on_threads(plan: Plan, parts: Sequence[Part], threads: int) -> Iterator[Simulated]:
    """Yields the results of parts, each of them simulated on several threads."""
    # without a pool MuJoCo steps on the calling thread
    with Rollout(nthread=threads if threads > 1 else 0) as pool:
        yield from map(Simulator(plan, pool, threads), parts)


def _together(model: mujoco.MjModel, parts: Sequence[Simulated]) -> Rollouts:
    """Returns all parts in one; warns of bodies that were too fast."""
    approaches = sum((part.approaches for part in parts), Approaches())
    remark = approaches.remark(float(model.opt.timestep))
    if remark is not None:
        warnings.warn(remark.text, ImpactWarning, stacklevel=3)
    states, sensors, final = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("states", "sensors", "final")
    )
    nq = model.nq
    return Rollouts(
        time=states[0, :, 0],
        qpos=states[:, :, 1 : 1 + nq],
        qvel=states[:, :, 1 + nq :],
        sensordata=sensors,
        final_state=final,
    )


def initial_states(
    model: mujoco.MjModel,
    *,
    qpos: npt.ArrayLike | None = None,
    qvel: npt.ArrayLike | None = None,
    keyframe: Keyframe = None,
) -> Array:
    """Returns states to start from (`STATE`), shape (N, n_state).

    Args:
        model: The model.
        qpos: Positions, shape (N, nq), or (nq,) for all; by default of the keyframe.
        qvel: Velocities, shape (N, nv), or (nv,) for all; by default of the keyframe.
        keyframe: See `run`.

    Raises:
        SceneError: If a shape does not fit or there is no such keyframe.
    """
    state = qpos is not None or qvel is not None
    start = settled(keyframe_names(model), keyframe, given=state)
    data = initial_data(model, keyframe=start)
    given = {
        name: _rows(name, values, getattr(data, name).size)
        for name, values in (("qpos", qpos), ("qvel", qvel))
        if values is not None
    }
    count = max((len(rows) for rows in given.values()), default=1)
    states = np.empty((count, mujoco.mj_stateSize(model, STATE)))
    for index in range(count):
        for name, rows in given.items():
            if len(rows) not in (1, count):
                msg = f"{name} has {len(rows)} rows, but there are {count} simulations"
                raise SceneError(msg)
            getattr(data, name)[:] = rows[index % len(rows)]
        mujoco.mj_getState(model, data, states[index], STATE)
    return states


def _rows(name: str, values: npt.ArrayLike, size: int) -> Array:
    """Returns values as rows of that size; SceneError if they are not."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim not in (1, 2) or array.shape[-1] != size or array.size == 0:
        msg = f"{name} has shape {array.shape}, allowed: ({size},) and (N, {size})"
        raise SceneError(msg)
    return array.reshape(-1, size)


def _given_states(
    model: mujoco.MjModel, states: npt.ArrayLike, others: tuple[object, ...]
) -> Array:
    """Returns whole initial states; SceneError if they are not, or not alone."""
    if any(other is not None for other in others):
        msg = "initial_state holds all of the state: give no qpos, qvel or keyframe"
        raise SceneError(msg)
    return _rows("initial_state", states, mujoco.mj_stateSize(model, STATE))


def _controls(
    model: mujoco.MjModel, control: npt.ArrayLike | None, count: int, steps: int
) -> Array | None:
    """Returns controls for every simulation, shape (count, steps, nu)."""
    if control is None:
        return None
    array = np.asarray(control, dtype=np.float64)
    try:
        return np.broadcast_to(array, (count, steps, model.nu))
    except ValueError:
        msg = (
            f"control has shape {array.shape}, allowed: ({steps}, {model.nu}) and "
            f"({count}, {steps}, {model.nu})"
        )
        raise SceneError(msg) from None


def thread_count(threads: int | None) -> int:
    """Returns the number of threads; ValueError if it is not positive."""
    if threads is None:
        return os.cpu_count() or 1
    if threads < 1:
        raise ValueError(f"threads = {threads}: must be >= 1")
    return threads
