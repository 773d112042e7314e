"""Many simulations of one model on several threads.

A thin layer over `mujoco.rollout`: initial states by position and velocity, progress,
and only as many samples kept as asked for. The numbers are those of single steps, bit
for bit, on any number of threads.
"""

from __future__ import annotations

import dataclasses
import os
import warnings
from collections.abc import Callable

import mujoco
import numpy as np
import numpy.typing as npt
from mujoco.rollout import Rollout

from mujoco_impact import _plugin
from mujoco_impact.errors import ImpactWarning, SceneError, SimulationError
from mujoco_impact.recordings import check_recording
from mujoco_impact.runner import (
    Model,
    collected_warnings,
    initial_data,
    load_model,
    step_count,
)
from mujoco_impact.starts import Keyframe, keyframe_names, settled
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.encounters import owned_numbers
from mujoco_impact.verdict.fast_bodies import FastBodies

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
"""What the states of a rollout hold: time, positions, velocities, activations and the
state of the plugin."""

CHUNK_BYTES = 64e6
"""Size of the states of one call of MuJoCo; `every` thins them after each call."""


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
        progress: Called after each part with the finished fraction, 0 to 1.

    Raises:
        SceneError: If the model or an initial state is not valid.
        SimulationError: If MuJoCo gives a warning, for example on divergence.
        ValueError: If another argument is not valid.
    """
    _plugin.load()
    compiled = load_model(model)
    steps = step_count(compiled, duration)
    workers = thread_count(threads)
    if not 1 <= every <= steps:
        raise ValueError(f"every = {every}: must be 1 to {steps}, the number of steps")
    if initial_state is None:
        start = initial_states(compiled, qpos=qpos, qvel=qvel, keyframe=keyframe)
    else:
        start = _given_states(compiled, initial_state, (qpos, qvel, keyframe))
    controls = _controls(compiled, control, len(start), steps)
    rows = _rows_per_call(compiled, steps, workers)
    numbers = mujoco.mj_stateSize(compiled, STATE) + int(compiled.nsensordata)
    check_recording(min(rows, len(start)) * steps, numbers)
    check_recording(len(start) * (steps // every), numbers)
    # without a pool MuJoCo steps on the calling thread
    with Rollout(nthread=workers if workers > 1 else 0) as pool:
        run = _Run(compiled, steps, every, workers, pool)
        for first in range(0, len(start), rows):
            part = slice(first, first + rows)
            run.add(start[part], None if controls is None else controls[part], first)
            if progress is not None:
                progress(min(1.0, (first + rows) / len(start)))
    return run.result()


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


class _Run:
    """Collects the parts of a rollout."""

    def __init__(
        self,
        model: mujoco.MjModel,
        steps: int,
        every: int,
        threads: int,
        pool: Rollout,
    ) -> None:
        self._model = model
        self._steps = steps
        self._samples = slice(every - 1, steps, every)
        self._workers = [mujoco.MjData(model) for _ in range(threads)]
        self._pool = pool
        self._parts: list[tuple[Array, Array, Array]] = []
        self._fast = FastBodies(model, owned_numbers(model))

    def add(self, start: Array, control: Array | None, first: int) -> None:
        """Simulates from some of the initial states, of which `first` is the number."""
        with collected_warnings() as messages:
            states, sensors = self._pool.rollout(
                self._model, self._workers, start, control, nstep=self._steps
            )
        if messages:
            raise _failure(self._model, start, states, first, messages[0])
        self._look(states)
        kept = states[:, self._samples, : 1 + self._model.nq + self._model.nv].copy()
        self._parts.append(
            (kept, sensors[:, self._samples].copy(), states[:, -1].copy())
        )

    def _look(self, states: Array) -> None:
        """Looks for bodies that are too fast for their gap."""
        nq, nv = self._model.nq, self._model.nv
        rows = states.reshape(-1, states.shape[-1])
        self._fast.look_at_fastest(
            rows[:, 0], rows[:, 1 : 1 + nq], rows[:, 1 + nq : 1 + nq + nv]
        )

    def result(self) -> Rollouts:
        """Returns all parts in one; warns of bodies that were too fast."""
        remark = self._fast.remark()
        if remark is not None:
            warnings.warn(remark.text, ImpactWarning, stacklevel=3)
        states, sensors, final = map(np.concatenate, zip(*self._parts, strict=True))
        nq = self._model.nq
        return Rollouts(
            time=states[0, :, 0],
            qpos=states[:, :, 1 : 1 + nq],
            qvel=states[:, :, 1 + nq :],
            sensordata=sensors,
            final_state=final,
        )


def _failure(
    model: mujoco.MjModel, start: Array, states: Array, first: int, message: str
) -> SimulationError:
    """Returns the error that says which simulation failed, and when."""
    # MuJoCo repeats the state after a warning, or has reset it: time does not go on
    time = np.concatenate([start[:, None, 0], states[:, :, 0]], axis=1)
    going = np.diff(time, axis=1) > 0.5 * model.opt.timestep
    row = int(np.argmin(going.all(axis=1)))
    last = float(time[row, int(np.argmin(going[row]))])
    return SimulationError(
        f"MuJoCo gave a warning in simulation {first + row} by {last:.6g} s: "
        f"{message.strip()}",
        time=last,
    )


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


def _rows_per_call(model: mujoco.MjModel, steps: int, threads: int) -> int:
    """Returns how many simulations fit into one call; a multiple of the threads."""
    numbers = mujoco.mj_stateSize(model, STATE) + int(model.nsensordata)
    fitting = int(CHUNK_BYTES / (8 * numbers * steps))
    return max(1, fitting // threads) * threads
