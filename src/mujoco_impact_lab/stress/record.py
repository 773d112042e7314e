"""Running a case of balls, and what is observed of it."""

from __future__ import annotations

import dataclasses

import mujoco

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.case import Case
from mujoco_impact_lab.stress.layouts import Balls
from mujoco_impact_lab.stress.methods import OURS, model_of
from mujoco_impact_lab.stress.observe import Observation, energies, observe
from mujoco_impact_lab.stress.scene import initial_velocity, mjcf, positions, velocities


@dataclasses.dataclass(frozen=True, eq=False)
class Record(Observation):
    """What is known of one run of a case.

    Attributes:
        balls: The balls at its start.
        position: Centres in each sample [m], shape (n_samples, n, 3).
        velocity: Of the centres [m/s], shape (n_samples, n, 3).
        energy: Potential plus kinetic energy as MuJoCo counts them [J], shape
            (n_samples,); None where it is not conserved, or kinetic alone.
    """

    balls: Balls
    position: Array
    velocity: Array
    energy: Array | None


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
    seen = observe(model, initial_velocity(case, balls), case.steps)
    model.opt.disableflags = disabled
    # the energies of free balls are their kinetic ones
    needed = case.is_elastic and case.is_conservative and not case.is_free
    return Record(
        **vars(seen),
        balls=balls,
        position=positions(case, balls, seen.qpos),
        velocity=velocities(case, balls, seen.qpos, seen.qvel),
        energy=energies(model, seen.qpos, seen.qvel).sum(axis=1) if needed else None,
    )
