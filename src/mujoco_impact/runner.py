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
from mujoco_impact.errors import ImpactWarning, SceneError, SimulationError
from mujoco_impact.limits import check_recording, steps_of
from mujoco_impact.mocap_bodies import mocap_bodies, potential
from mujoco_impact.pulses import PulseReader
from mujoco_impact.remarks import NO_IMPACT, Remark
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.trajectory import Array, Trajectory
from mujoco_impact.verdict import RunWatch

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
    keyframe: str | int | None = None,
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
        model: Compiled model (not changed), specification, path or XML text.
        duration: Simulated time [s].
        keyframe: Name or number of the keyframe to start from; by default the
            model's initial state.
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
        SimulationError: If MuJoCo gives a warning, for example on divergence.
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
    data = initial_data(compiled, keyframe=keyframe, qpos=qpos, qvel=qvel)
    recorder = _Recorder(
        compiled,
        data,
        samples=steps // every + 1,
        every=every,
        controlled=controller is not None,
    )
    with collected_warnings() as messages:
        for step in range(steps):
            if controller is not None:
                controller(compiled, data)
                recorder.watch.after_controller()
            mujoco.mj_step(compiled, data)
            if messages:
                # this step has not left the energy of its start
                recorder.warn(samples=-(-step // every))
                raise _simulation_error(messages, step * compiled.opt.timestep)
            recorder.after_step(step, every)
            if progress is not None and step % max(1, steps // PROGRESS_CALLS) == 0:
                progress(step / steps)
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
    keyframe: str | int | None = None,
    qpos: npt.ArrayLike | None = None,
    qvel: npt.ArrayLike | None = None,
) -> mujoco.MjData:
    """Returns the data of a simulation about to start.

    Raises:
        SceneError: If there is no such keyframe or a state has the wrong shape.
    """
    data = mujoco.MjData(model)
    if keyframe is not None:
        mujoco.mj_resetDataKeyframe(model, data, _keyframe_number(model, keyframe))
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
    ) -> None:
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

    def warn(self, *, samples: int, level: int = 3) -> tuple[Remark, ...]:
        """Warns of what a number of samples have to say, and returns it.

        Args:
            samples: The samples that are filled.
            level: Calls from the one that the warning is about down to here.
        """
        remarks = self.watch.remarks(
            self._time[:samples], self._energy[:samples], self._pulses.impacts
        )
        for remark in remarks:
            # that nothing touched is no fault: the list of impacts says it
            if remark.kind != NO_IMPACT:
                warnings.warn(remark.text, ImpactWarning, stacklevel=level)
        return remarks

    def trajectory(self) -> Trajectory:
        """Returns the finished trajectory."""
        if not self._runge_kutta:
            self._energy[-1] = self._energy_at(-1)
        if self._pulses.missed:
            warnings.warn(
                f"{self._pulses.missed} impacts have no record: more of them began in "
                "one step than the plugin has slots; their motion is computed",
                ImpactWarning,
                stacklevel=3,
            )
        return Trajectory(
            time=self._time,
            qpos=self._qpos,
            qvel=self._qvel,
            energy=self._energy,
            impacts=tuple(sorted(self._pulses.impacts, key=lambda one: one.time)),
            timestep=float(self._model.opt.timestep),
            integrator=integrator_name(self._model),
            mujoco_version=mujoco.mj_versionString(),
            missed_impacts=self._pulses.missed,
            remarks=self.warn(samples=len(self._energy), level=4),
        )

    def _sample(self, index: int) -> None:
        """Records the present state."""
        self._time[index] = self._data.time
        self._qpos[index] = self._data.qpos
        self._qvel[index] = self._data.qvel
        if self._runge_kutta:
            self._energy[index] = self._energy_at(index)

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


def _keyframe_number(model: mujoco.MjModel, keyframe: str | int) -> int:
    """Returns the number of a keyframe; SceneError if there is none."""
    names = [model.key(number).name for number in range(model.nkey)]
    if isinstance(keyframe, str) and keyframe in names:
        return names.index(keyframe)
    if isinstance(keyframe, int) and 0 <= keyframe < model.nkey:
        return keyframe
    available = ", ".join(
        repr(name) if name else str(number) for number, name in enumerate(names)
    )
    msg = f"there is no keyframe {keyframe!r} (available: {available or 'none'})"
    raise SceneError(msg)


def _simulation_error(messages: list[str], time: float) -> SimulationError:
    """Returns the error for MuJoCo's warnings in the step from `time` on."""
    return SimulationError(
        f"MuJoCo gave a warning in the step at {time:.6g} s: {messages[0].strip()}",
        time=time,
    )
