"""What the bodies of a motion do, for the plots of a report."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array, Trajectory

MOST_BODIES = 10
"""Bodies that are drawn at most: those that are fastest."""

MOST_SAMPLES = 1500
"""Samples that are looked at."""


@dataclasses.dataclass(frozen=True, eq=False)
class Motion:
    """Positions and speeds of the bodies that move.

    Attributes:
        time: Times of the samples [s], shape (n,).
        positions: Centres of mass [m], shape (n, bodies, 3).
        speeds: Their speeds [m/s], shape (n, bodies).
    """

    time: Array
    positions: Array
    speeds: Array


def motion_of(
    model: mujoco.MjModel, trajectory: Trajectory, bodies: list[int]
) -> Motion:
    """Returns what bodies do in a motion.

    Args:
        model: A model of the scene; its contacts do not matter.
        trajectory: The motion.
        bodies: Their ids.
    """
    every = max(1, -(-len(trajectory.time) // MOST_SAMPLES))
    time = trajectory.time[::every]
    positions = np.zeros((len(time), len(bodies), 3))
    speeds = np.zeros((len(time), len(bodies)))
    data = mujoco.MjData(model)
    velocity: Array = np.zeros(6)
    kind = mujoco.mjtObj.mjOBJ_BODY
    for sample, index in enumerate(range(0, len(trajectory.time), every)):
        data.qpos[:] = trajectory.qpos[index]
        data.qvel[:] = trajectory.qvel[index]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        positions[sample] = data.xipos[bodies]
        for place, body in enumerate(bodies):
            mujoco.mj_objectVelocity(model, data, kind, body, velocity, 0)
            speeds[sample, place] = np.linalg.norm(velocity[3:])
    return Motion(time, positions, speeds)


def moving_bodies(model: mujoco.MjModel, trajectory: Trajectory) -> list[int]:
    """Returns the ids of the bodies that are fastest, in the order of the model."""
    able = np.flatnonzero(model.body_weldid != 0)
    massive = [int(body) for body in able if model.body_mass[body] > 0]
    if len(massive) <= MOST_BODIES:
        return massive
    top = motion_of(model, trajectory, massive).speeds.max(axis=0)
    chosen = np.argsort(-top)[:MOST_BODIES]
    return sorted(massive[index] for index in chosen)


def names_of(model: mujoco.MjModel, bodies: list[int]) -> list[str]:
    """Returns the names of bodies."""
    return [model.body(body).name or f"body {body}" for body in bodies]


def plane_of(motion: Motion) -> tuple[int, int]:
    """Returns the two of x, y, z along which bodies move most."""
    ways = np.ptp(motion.positions, axis=0).max(axis=0)
    first, second = sorted(np.argsort(-ways)[:2].tolist())
    return first, second
