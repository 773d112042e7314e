"""Running a scene headless."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TypeAlias

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact import _plugin
from mujoco_impact.errors import (
    RunInterrupted,
    SceneError,
    SimulationError,
)
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.recorder import Recorder
from mujoco_impact.recordings import check_recording, steps_of
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.starts import (
    Keyframe,
    keyframe_names,
    settled,
    start_number,
    start_told,
)
from mujoco_impact.trajectory import Trajectory

Model: TypeAlias = mujoco.MjModel | Source
"""A compiled model, or anything that can be compiled to one."""

Controller: TypeAlias = Callable[[mujoco.MjModel, mujoco.MjData], None]
"""Called before each step; may set `data.ctrl` and applied forces."""

PROGRESS_CALLS = 100
"""How often a run reports progress."""


def run(
    model: Model,
    *,
    duration: float,
    keyframe: Keyframe = None,
    qpos: npt.ArrayLike | None = None,
    qvel: npt.ArrayLike | None = None,
    every: int = 1,
    controller: Controller | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Simulates a model and records states, energies and impacts.

    The model is stepped as it is: give `attach(scene)` to have its impacts computed by
    the plugin, the scene itself to have MuJoCo's own contacts.

    Args:
        model: Compiled model (not changed), specification, path, XML text or name of
            a shipped model.
        duration: Simulated time [s].
        keyframe: Name or number of the keyframe to start from, "none" for the model's
            initial state. Default: the keyframe "release" or the only one of the
            model, if it has one and neither `qpos` nor `qvel` is given.
        qpos: Initial positions, shape (nq,), instead of those of the keyframe.
        qvel: Initial velocities, shape (nv,), instead of those of the keyframe.
        every: Steps between two samples; at most all of the run.
        controller: Called before each step with the model and the data.
        progress: Called now and then with the finished fraction, 0 to 1.

    Returns:
        The trajectory; its first sample is the initial state. What went wrong without
        an error, such as bodies too fast for their gap, stands in its `remarks` and is
        warned of once (`ImpactWarning`).

    Raises:
        SceneError: If the model or the initial state is not valid.
        SimulationError: If MuJoCo gives a warning, for example on divergence; holds
            the motion until then.
        RunInterrupted: On Ctrl-C; it is a KeyboardInterrupt, and holds the motion until
            then, too.
        ValueError: If `duration` or `every` is not valid, or asks for more memory than
            a run may take.
    """
    _plugin.load()
    compiled = load_model(model)
    steps = step_count(compiled, duration)
    if not 1 <= every <= steps:
        msg = f"every = {every}: must be 1 to {steps}, the number of steps"
        raise ValueError(msg)
    # time, positions, velocities and two energies
    check_recording(steps // every + 1, 3 + compiled.nq + compiled.nv)
    # MuJoCo fills in the energies only if asked to; nothing else depends on the flag
    compiled.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    names = keyframe_names(compiled)
    given = qpos is not None or qvel is not None
    number = settled(names, keyframe, given=given)
    data = initial_data(compiled, keyframe=number, qpos=qpos, qvel=qvel)
    start = "a given state" if given else start_told(names, number)
    recorder = Recorder(
        compiled,
        data,
        samples=steps // every + 1,
        every=every,
        controlled=controller is not None,
        start=start,
    )
    with collected_warnings() as messages:
        try:
            for step in range(steps):
                if controller is not None:
                    controller(compiled, data)
                    recorder.watch.after_controller()
                mujoco.mj_step(compiled, data)
                if messages:
                    raise _simulation_error(
                        messages,
                        step * compiled.opt.timestep,
                        recorder.trajectory(failed=True),
                    )
                recorder.after_step(step, every)
                if progress is not None and step % max(1, steps // PROGRESS_CALLS) == 0:
                    progress(step / steps)
        except KeyboardInterrupt:
            raise RunInterrupted(recorder.trajectory()) from None
    if progress is not None:
        progress(1.0)
    return recorder.trajectory()


def load_model(model: Model) -> mujoco.MjModel:
    """Returns a model of its own: a copy, or a compiled scene."""
    if isinstance(model, mujoco.MjModel):
        return copy.copy(model)
    return compile_spec(read_spec(model))


def step_count(model: mujoco.MjModel, duration: float) -> int:
    """Returns the number of steps that make up a duration.

    Raises:
        ValueError: If the duration is not a positive time, or too long.
    """
    return steps_of(duration, float(model.opt.timestep))


def initial_data(
    model: mujoco.MjModel,
    *,
    keyframe: Keyframe = None,
    qpos: npt.ArrayLike | None = None,
    qvel: npt.ArrayLike | None = None,
) -> mujoco.MjData:
    """Returns the data of a simulation about to start; None: in the initial state.

    Raises:
        SceneError: If there is no such keyframe or a state has the wrong shape.
    """
    data = mujoco.MjData(model)
    if keyframe is not None:
        number = start_number(keyframe_names(model), keyframe)
        if number is not None:  # "none" is the initial state, too
            mujoco.mj_resetDataKeyframe(model, data, number)
    for name, values in (("qpos", qpos), ("qvel", qvel)):
        if values is None:
            continue
        state = getattr(data, name)
        array = np.asarray(values, dtype=np.float64)
        if array.shape != state.shape:
            msg = f"{name} has shape {array.shape}, the model needs {state.shape}"
            raise SceneError(msg)
        state[:] = array
    return data


def _simulation_error(
    messages: list[str], time: float, trajectory: Trajectory
) -> SimulationError:
    """Returns the error for MuJoCo's warnings in the step from `time` on."""
    return SimulationError(
        f"MuJoCo gave a warning in the step at {time:.6g} s: {messages[0].strip()}",
        time=time,
        trajectory=trajectory,
    )
