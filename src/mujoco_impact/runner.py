"""Running a scene headless."""

from __future__ import annotations

import contextlib
import copy
import warnings
from collections.abc import Callable, Iterator
from typing import TypeAlias

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact import _plugin
from mujoco_impact.energies import find_energies
from mujoco_impact.errors import (
    ImpactWarning,
    RunInterrupted,
    SceneError,
    SimulationError,
)
from mujoco_impact.pulses import PulseReader
from mujoco_impact.recordings import check_recording, steps_of
from mujoco_impact.remarks import QUIET
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.starts import (
    Keyframe,
    keyframe_names,
    settled,
    start_number,
    start_told,
)
from mujoco_impact.trajectory import Array, Trajectory
from mujoco_impact.verdict import RunWatch
from mujoco_impact.verdict.mocap_bodies import mocap_bodies, potential

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
    recorder = _Recorder(
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


@contextlib.contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Collects MuJoCo's warnings instead of writing them to MUJOCO_LOG.TXT.

    MuJoCo has one warning handler per process, so warnings of simulations that other
    threads run meanwhile are collected, too.
    """
    messages: list[str] = []
    previous = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(messages.append)
    try:
        yield messages
    finally:
        mujoco.set_mju_user_warning(previous)


class _Recorder:
    """Fills the arrays of a trajectory while a simulation runs."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        samples: int,
        every: int,
        controlled: bool,
        start: str,
    ) -> None:
        self._start = start
        self._samples = 0
        self._model = model
        self._data = data
        self._time: Array = np.zeros(samples)
        self._qpos: Array = np.zeros((samples, model.nq))
        self._qvel: Array = np.zeros((samples, model.nv))
        self._energy: Array = np.zeros((samples, 2))
        self._pulses = PulseReader(model, data)
        # A Runge-Kutta step leaves the energy of its last stage, not of its start.
        self._runge_kutta = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
        self._scratch = copy.copy(data)
        self._by_hand = mocap_bodies(model)
        self.watch = RunWatch(model, data, every=every, controlled=controlled)
        self._sample(0)

    def after_step(self, step: int, every: int) -> None:
        """Records what step number `step` (from 0) brought."""
        self._pulses.poll()
        self.watch.after_step()
        if step % every == 0 and not self._runge_kutta:
            # a step computes the energy of the state that it starts from
            self._energy[step // every] = self._energy_of(self._data)
        if (step + 1) % every == 0:
            self._sample((step + 1) // every)

    def trajectory(self, *, failed: bool = False) -> Trajectory:
        """Returns what was recorded so far, and warns of what it has to say.

        Args:
            failed: Whether the step from the last sample failed: that sample is kept,
                and not judged.
        """
        count = self._samples
        if not self._runge_kutta:
            # the step from the last sample has not been taken
            self._energy[count - 1] = self._energy_at(count - 1)
        if self._pulses.missed:
            warnings.warn(
                f"{self._pulses.missed} impacts have no record: more of them began in "
                "one step than the plugin has slots; their motion is computed",
                ImpactWarning,
                stacklevel=3,
            )
        time, energy = self._time[:count], self._energy[:count]
        judged = count - 1 if failed else count
        remarks = self.watch.remarks(
            time[:judged], energy[:judged], self._pulses.impacts
        )
        for remark in remarks:
            if remark.kind not in QUIET:
                warnings.warn(remark.text, ImpactWarning, stacklevel=3)
        return Trajectory(
            time=time,
            qpos=self._qpos[:count],
            qvel=self._qvel[:count],
            energy=energy,
            impacts=tuple(sorted(self._pulses.impacts, key=lambda one: one.time)),
            timestep=float(self._model.opt.timestep),
            integrator=integrator_name(self._model),
            mujoco_version=mujoco.mj_versionString(),
            missed_impacts=self._pulses.missed,
            remarks=remarks,
            start=self._start,
        )

    def _sample(self, index: int) -> None:
        """Records the present state."""
        self._time[index] = self._data.time
        self._qpos[index] = self._data.qpos
        self._qvel[index] = self._data.qvel
        if self._runge_kutta:
            self._energy[index] = self._energy_at(index)
        self._samples = index + 1

    def _energy_at(self, sample: int) -> Array:
        """Returns potential and kinetic energy of a sample [J], shape (2,)."""
        self._scratch.qpos[:] = self._qpos[sample]
        self._scratch.qvel[:] = self._qvel[sample]
        self._scratch.mocap_pos[:] = self._data.mocap_pos
        self._scratch.mocap_quat[:] = self._data.mocap_quat
        find_energies(self._model, self._scratch)
        return self._energy_of(self._scratch)

    def _energy_of(self, data: mujoco.MjData) -> Array:
        """Returns the energies in `data` without the weight of mocap bodies [J]."""
        energy: Array = np.array(data.energy)
        if self._by_hand.size:
            energy[0] -= potential(self._model, data, self._by_hand)
        return energy


def integrator_name(model: mujoco.MjModel) -> str:
    """Returns the integrator as MJCF spells it, for example "Euler" or "RK4"."""
    name = str(mujoco.mjtIntegrator(model.opt.integrator).name)
    name = name.removeprefix("mjINT_")
    return {"EULER": "Euler", "RK4": "RK4"}.get(name, name.lower())


def _simulation_error(
    messages: list[str], time: float, trajectory: Trajectory
) -> SimulationError:
    """Returns the error for MuJoCo's warnings in the step from `time` on."""
    return SimulationError(
        f"MuJoCo gave a warning in the step at {time:.6g} s: {messages[0].strip()}",
        time=time,
        trajectory=trajectory,
    )
