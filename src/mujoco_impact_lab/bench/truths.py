"""What is right in a scene, and how far a motion is from it."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np

from mujoco_impact import metrics
from mujoco_impact.reference import (
    Chain,
    ReferenceTrajectory,
    first_impact,
    free_flight,
    swing,
    time_to_contact,
)
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import VELOCITY_DELAY, BenchScene


@dataclasses.dataclass(frozen=True)
class Errors:
    """How far a motion is from the truth; nan where there is no truth.

    Attributes:
        velocity: RMS over the balls of the velocities after the first impact, in
            fractions of the impact speed.
        angle_rms: RMS over balls and time [rad].
        energy_drift: Change of energy over the run, in fractions of it at the start.
    """

    velocity: float
    angle_rms: float = math.nan
    energy_drift: float = math.nan


@dataclasses.dataclass(frozen=True, eq=False)
class Truth:
    """The truth of a scene.

    Attributes:
        chain: The row.
        onset: Time of first contact [s].
        speed: Speed of the incoming balls then, v0 [m/s].
        velocities: Velocities that the first impact leaves, over v0, shape (n,).
        motion: The whole motion; None if only the first impact is known.
    """

    chain: Chain
    onset: float
    speed: float
    velocities: Array
    motion: ReferenceTrajectory | None


def truth_of(scene: BenchScene) -> Truth:
    """Returns the Hertz reference of a scene.

    Elastic rows are integrated as they swing; impacts that lose energy as the impact
    of a straight row with the bi-stiffness law; free balls on strings as that of a
    straight row, too, since their strings do not move while they touch.
    """
    chain, (angles, velocities) = scene.chain(), scene.start()
    onset = time_to_contact(chain, angles, velocities, scene.duration)
    if onset is None:
        msg = f"the balls of scene {scene.name} do not meet within {scene.duration} s"
        raise ValueError(msg)
    swing_rate = free_flight(angles, velocities, chain.frequency, onset)[1]
    speed = float(np.abs(swing_rate).max()) * chain.length
    # the velocities are read a little later: one long timestep of room
    known = scene.duration if scene.swings else onset + VELOCITY_DELAY + 0.05
    if scene.restitution == 1.0 and scene.is_row:
        motion = _swing(scene.pattern, scene.true_gap, scene.released, known)
        times = np.array([0.0, onset + VELOCITY_DELAY])
        left = metrics.velocity_after_first_impact(times, *motion(times), chain)
        return Truth(chain, onset, speed, left, motion if scene.swings else None)
    straight = first_impact(
        chain.masses,
        chain.radii,
        n_incoming=scene.released,
        restitution=scene.restitution,
        dissipation=None if scene.restitution == 1.0 else "bistiffness",
    )
    return Truth(chain, onset, speed, straight.velocities, None)


@cache
def _swing(
    pattern: str, gap: float, released: int, duration: float
) -> ReferenceTrajectory:
    """Returns the motion of an elastic row; several scenes share one."""
    scene = BenchScene("", "", pattern, released=released, true_gap=gap)
    return swing(scene.chain(), *scene.start(), duration)


def row_errors(scene: BenchScene, truth: Truth, samples: Samples) -> Errors:
    """Returns the errors of a motion of a row."""
    chain = truth.chain
    time, angles, velocities = corrected(samples, chain)
    if truth.motion is not None:
        found = metrics.row_errors(
            time, angles, velocities, truth.motion, delay=VELOCITY_DELAY
        )
        return Errors(found.velocity, found.angle_rms, found.energy_drift)
    left = metrics.velocity_after_first_impact(
        time, angles, velocities, chain, delay=VELOCITY_DELAY
    )
    drift = math.nan
    if scene.restitution == 1.0:
        drift = metrics.energy_drift(angles, velocities, chain)
    return Errors(rms(left - truth.velocities), energy_drift=drift)


def corrected(samples: Samples, chain: Chain) -> tuple[Array, Array, Array]:
    """Returns times, angles and velocities without the half-step offset."""
    if not samples.shift:
        return samples.time, samples.angles, samples.velocities
    time, angles, velocities = metrics.euler_half_step(
        samples.time,
        samples.angles,
        samples.velocities,
        chain,
        timestep=samples.shift,
    )
    began = time >= 0
    return time[began], angles[began], velocities[began]


def rms(values: Array) -> float:
    """Returns the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
