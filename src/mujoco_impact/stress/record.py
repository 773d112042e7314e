"""Running a case, and what is observed of it."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.pulses import PulseReader
from mujoco_impact.runner import collected_warnings
from mujoco_impact.stress.case import Case
from mujoco_impact.stress.layouts import Balls
from mujoco_impact.stress.methods import OURS, model_of
from mujoco_impact.stress.scene import initial_velocity, mjcf, positions, velocities
from mujoco_impact.trajectory import Array, Impact


@dataclasses.dataclass(frozen=True, eq=False)
class Record:
    """What is known of one run of a case.

    Attributes:
        balls: The balls at its start.
        position: Centres in each sample [m], shape (n_samples, n, 3); the first sample
            is the start, the others follow the steps.
        velocity: Of the centres [m/s], shape (n_samples, n, 3).
        energy: Potential plus kinetic energy as MuJoCo counts them [J], shape
            (n_samples,); None where it is not conserved, or kinetic alone.
        quiet: Whether no contact force acts between a sample and its neighbours:
            every pulse is delivered and no contact is MuJoCo's, shape (n_samples,).
        struck: Whether an impact began in a step, shape (n_samples - 1,).
        native: Whether MuJoCo's own contacts took part.
        limited: Whether a joint limit held a ball.
        impacts: The impacts of the plugin.
        missed: Impacts without a record.
        warnings: What MuJoCo warned of.
        bits: The last state, plugin state included.
    """

    balls: Balls
    position: Array
    velocity: Array
    energy: Array | None
    quiet: Array
    struck: Array
    native: bool
    limited: bool
    impacts: tuple[Impact, ...]
    missed: int
    warnings: tuple[str, ...]
    bits: bytes


def record(
    case: Case,
    balls: Balls,
    method: str = OURS,
    *,
    contacts: bool = True,
    tolerance: float | None = None,
) -> Record:
    """Runs a case once.

    Args:
        case: The case.
        balls: Its balls, or an image of them.
        method: Of `METHODS`.
        contacts: Whether balls meet at all.
        tolerance: Of our impact law; None for the default.
    """
    model = model_of(method, case, mjcf(case, balls), balls, tolerance=tolerance)
    return run_model(model, case, balls, contacts=contacts)


def run_model(
    model: mujoco.MjModel, case: Case, balls: Balls, *, contacts: bool = True
) -> Record:
    """Runs a compiled case once."""
    disabled = model.opt.disableflags
    if not contacts:
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    data.qvel[:] = initial_velocity(case, balls)
    data.ctrl[:] = 1.0
    samples = case.steps + 1
    qpos, qvel = np.zeros((samples, model.nq)), np.zeros((samples, model.nv))
    busy = np.zeros(samples, dtype=bool)
    struck = np.zeros(case.steps, dtype=bool)
    pulses = PulseReader(model, data)
    until = -np.inf
    qpos[0], qvel[0] = data.qpos, data.qvel
    native, limited, seen = False, False, 0
    with collected_warnings() as messages:
        for step in range(case.steps):
            mujoco.mj_step(model, data)
            qpos[step + 1], qvel[step + 1] = data.qpos, data.qvel
            # a step finds the contacts of the state that it starts from
            limited = limited or _is_limiting(data)
            if _is_pushing(data):
                busy[step] = busy[step + 1] = native = True
            pulses.poll()
            struck[step] = len(pulses.impacts) > seen
            for impact in pulses.impacts[seen:]:
                until = max(until, impact.time + impact.duration)
            seen = len(pulses.impacts)
            # an impact may be recorded as longer than it is delivered: rounding
            busy[step + 1] |= data.time < until * (1 - 1e-12)
        bits = data.qpos.tobytes() + data.qvel.tobytes() + data.plugin_state.tobytes()
    model.opt.disableflags = disabled
    return Record(
        balls=balls,
        position=positions(case, balls, qpos),
        velocity=velocities(case, balls, qpos, qvel),
        energy=_energies_of(case, model, qpos, qvel),
        quiet=~busy,
        struck=struck,
        native=native,
        limited=limited,
        impacts=tuple(pulses.impacts),
        missed=pulses.missed,
        warnings=tuple(messages),
        bits=bits,
    )


def _is_pushing(data: mujoco.MjData) -> bool:
    """Whether a contact of MuJoCo exerts a force."""
    if not data.nefc:
        return False
    address = data.contact.efc_address
    return bool(np.any(data.efc_force[address[address >= 0]]))


def _is_limiting(data: mujoco.MjData) -> bool:
    """Whether a joint limit exerts a force."""
    limits = data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT
    return bool(np.any(data.efc_force[limits]))


def _energies_of(
    case: Case, model: mujoco.MjModel, qpos: Array, qvel: Array
) -> Array | None:
    """Returns the energies of a run; those of free balls are their kinetic ones."""
    needed = case.is_elastic and case.is_conservative and not case.is_free
    return energies(model, qpos, qvel) if needed else None


def energies(model: mujoco.MjModel, qpos: Array, qvel: Array) -> Array:
    """Returns potential plus kinetic energy of each sample [J], shape (n_samples,)."""
    data = mujoco.MjData(model)
    result = np.zeros(len(qpos))
    for sample, (position, velocity) in enumerate(zip(qpos, qvel, strict=True)):
        data.qpos[:], data.qvel[:] = position, velocity
        for stage in _ENERGY_STAGES:
            stage(model, data)
        result[sample] = data.energy.sum()
    return result


_ENERGY_STAGES = (
    mujoco.mj_kinematics,
    mujoco.mj_comPos,
    mujoco.mj_tendon,
    mujoco.mj_makeM,
    mujoco.mj_energyPos,
    mujoco.mj_energyVel,
)
