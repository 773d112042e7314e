"""Stepping a model, and what is seen while it runs: the same for every family."""

from __future__ import annotations

import dataclasses
import time

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact.impact import Impact
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.pulses import PulseReader, plugin_instances, step_work
from mujoco_impact.recorder import find_energies
from mujoco_impact.trajectory import Array

_CONTACTS = int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)
"""First of the types of contact rows, which are the last of all types."""


@dataclasses.dataclass(frozen=True, eq=False)
class Observation:
    """What is seen of one run.

    Attributes:
        qpos: In each sample, shape (n_samples, nq); the first sample is the start, the
            others follow the steps.
        qvel: In each sample, shape (n_samples, nv).
        quiet: Whether no contact force acts between a sample and its neighbours:
            every pulse is delivered and no contact is MuJoCo's, shape (n_samples,).
        begun: How many of `impacts` began in a step, shape (n_samples - 1,).
        pushed: Whether MuJoCo's own contacts pushed in a step, shape (n_samples - 1,).
        impacts: The impacts of the plugin.
        missed: Impacts without a record.
        warnings: What MuJoCo warned of.
        bits: The last state, plugin state included.
        work: Counted work of the plugin in each step, over what it allows itself,
            shape (n_samples - 1,).
        seconds: Processor time of each step [s], shape (n_samples - 1,); no verdict may
            depend on it.
    """

    qpos: Array
    qvel: Array
    quiet: npt.NDArray[np.bool_]
    begun: npt.NDArray[np.int64]
    pushed: npt.NDArray[np.bool_]
    impacts: tuple[Impact, ...]
    missed: int
    warnings: tuple[str, ...]
    bits: bytes
    work: Array
    seconds: Array

    @property
    def struck(self) -> npt.NDArray[np.bool_]:
        """Whether an impact began in a step, shape (n_samples - 1,)."""
        return self.begun > 0

    @property
    def native(self) -> bool:
        """Whether MuJoCo's own contacts took part."""
        return bool(self.pushed.any())

    @property
    def is_sound(self) -> bool:
        """Whether MuJoCo did not reset the state, which it does if a run diverges."""
        return not self.warnings and bool(np.isfinite(self.qvel).all())


def observe(model: mujoco.MjModel, qvel: Array, steps: int) -> Observation:
    """Runs a model from its initial position.

    Args:
        model: The model.
        qvel: Velocity at the start, shape (nv,).
        steps: How many steps to take.
    """
    data = mujoco.MjData(model)
    data.qvel[:] = qvel
    data.ctrl[:] = 1.0
    qpos_of, qvel_of = np.zeros((steps + 1, model.nq)), np.zeros((steps + 1, model.nv))
    busy = np.zeros(steps + 1, dtype=bool)
    begun, pushed = np.zeros(steps, dtype=np.int64), np.zeros(steps, dtype=bool)
    work, seconds = np.zeros(steps), np.zeros(steps)
    instances = plugin_instances(model)
    pulses = PulseReader(model, data)
    until = -np.inf
    qpos_of[0], qvel_of[0] = data.qpos, data.qvel
    seen = 0
    with collected_warnings() as messages, _StageForces(model) as stages:
        for step in range(steps):
            stages.begin()
            begin = time.thread_time()
            mujoco.mj_step(model, data)
            seconds[step] = time.thread_time() - begin
            work[step] = step_work(model, data, instances)
            qpos_of[step + 1], qvel_of[step + 1] = data.qpos, data.qvel
            # a step finds the contacts of the state that it starts from
            pushed[step] = _is_pushing(model, data) or stages.acted
            pulses.poll()
            begun[step] = len(pulses.impacts) - seen
            for impact in pulses.impacts[seen:]:
                until = max(until, impact.time + impact.duration)
            seen = len(pulses.impacts)
            # an impact may be recorded as longer than it is delivered: rounding
            busy[step + 1] |= data.time < until * (1 - 1e-12)
        bits = data.qpos.tobytes() + data.qvel.tobytes() + data.plugin_state.tobytes()
    busy[:-1] |= pushed
    busy[1:] |= pushed
    return Observation(
        qpos=qpos_of,
        qvel=qvel_of,
        quiet=~busy,
        begun=begun,
        pushed=pushed,
        impacts=tuple(pulses.impacts),
        missed=pulses.missed,
        warnings=tuple(messages),
        bits=bits,
        work=work,
        seconds=seconds,
    )


def _is_pushing(model: mujoco.MjModel, data: mujoco.MjData) -> bool:
    """Whether a contact of MuJoCo exerts a force, normal or of friction.

    Under `discrete` any contact counts: one without force changes a step of bodies that
    turn, too.
    """
    contacts = data.efc_type >= _CONTACTS
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_DISCRETE:
        return bool(contacts.any())
    return bool(np.any(data.efc_force[contacts]))


class _StageForces:
    """Sees whether constraints act in the stages of a Runge-Kutta step but the last.

    MuJoCo calls back in each stage before it solves for the constraints, when their
    forces are still those of the stage before.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        """The other integrators have a single stage, of which nothing need be seen."""
        self._wanted = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
        self.begin()

    def begin(self) -> None:
        """A step begins."""
        self.acted, self._calls = False, 0

    def __enter__(self) -> _StageForces:
        """Looks at all stages until the end of the block."""
        if self._wanted:
            mujoco.set_mjcb_control(self._look)
        return self

    def __exit__(self, *_: object) -> None:
        """Looks no more."""
        if self._wanted:
            mujoco.set_mjcb_control(None)

    def _look(self, _: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Looks at the forces of the stage before, which at first is another step's."""
        self._calls += 1
        if self._calls > 1:
            self.acted = self.acted or bool(np.any(data.qfrc_constraint))


def energies(model: mujoco.MjModel, qpos: Array, qvel: Array) -> Array:
    """Returns potential and kinetic energy of each sample [J], shape (n_samples, 2)."""
    data = mujoco.MjData(model)
    result = np.zeros((len(qpos), 2))
    for sample, (position, velocity) in enumerate(zip(qpos, qvel, strict=True)):
        data.qpos[:], data.qvel[:] = position, velocity
        find_energies(model, data)
        result[sample] = data.energy
    return result
