"""A row of pendulums in a comparison: its Hertz reference, and its samples."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact import metrics
from mujoco_impact.comparing.pendulums import PendulumRow, find_row
from mujoco_impact.comparing.references import Material
from mujoco_impact.comparing.survey import HALF_STEP_INTEGRATORS
from mujoco_impact.errors import ImpactError
from mujoco_impact.reference import ReferenceTrajectory, swing
from mujoco_impact.trajectory import Array, Trajectory

MOST_REFERENCE_BALLS = 12
"""Longer rows are chaotic after the first wave, and their reference takes minutes."""


@dataclasses.dataclass(frozen=True, eq=False)
class RowReference:
    """What is known of a scene that is a row of pendulums.

    Attributes:
        row: The row.
        motion: Its Hertz reference, or None.
        velocities: Velocities that the first impact of the reference leaves, over its
            speed, or None.
        speed: Closing speed of that impact [m/s]; 0 without a reference.
        note: Why there is no reference, else empty.
    """

    row: PendulumRow
    motion: ReferenceTrajectory | None = None
    velocities: tuple[float, ...] | None = None
    speed: float = 0.0
    note: str = ""


def row_reference(
    model: mujoco.MjModel, motion: Trajectory, material: Material
) -> RowReference | None:
    """Returns the Hertz reference from the start of a motion; None if it is no row."""
    row = find_row(model, young=material.young, poisson=material.poisson)
    if row is None:
        return None
    if row.chain.count > MOST_REFERENCE_BALLS:
        note = f"no Hertz reference: more than {MOST_REFERENCE_BALLS} balls"
        return RowReference(row, note=note)
    if not material.uniform:
        return RowReference(
            row, note="no Hertz reference: the balls are of different materials"
        )
    if material.restitution != 1.0 or not material.hertz:
        note = "no Hertz reference: it is elastic, the law is not"
        return RowReference(row, note=note)
    time = motion.time
    start = row.angles(motion.qpos[0]), row.angles(motion.qvel[0])
    try:
        reference = swing(row.chain, *start, float(time[-1]))
        left = metrics.velocity_after_first_impact(time, *reference(time), row.chain)
    except ImpactError as error:
        return RowReference(row, note=f"no Hertz reference: {error}")
    onset = reference.contact_intervals[:1, 0]
    speed = float(np.abs(reference(onset)[1]).max()) * row.chain.length
    return RowReference(row, reference, tuple(left.tolist()), speed)


def row_samples(row: PendulumRow, motion: Trajectory) -> tuple[Array, Array, Array]:
    """Returns times, angles and velocities of a row, as exact as they can be read.

    MuJoCo's semi-implicit steps shift the motion of a row that starts at rest by half
    a step; that is no error of the impacts and is taken out.
    """
    angles, velocities = row.angles(motion.qpos), row.angles(motion.qvel)
    if motion.integrator not in HALF_STEP_INTEGRATORS or velocities[0].any():
        return motion.time, angles, velocities
    return metrics.euler_half_step(
        motion.time, angles, velocities, row.chain, timestep=motion.timestep
    )
