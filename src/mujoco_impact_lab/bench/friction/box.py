"""The bouncing box: once off its corner, edges and face, without gravity."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.friction.scene import (
    FrictionScene,
    free_bodies,
    numbers,
    truth_table,
)
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP

HALF = np.array([0.05, 0.07, 0.04])
"""Half-sizes [m]."""

INERTIA = (HALF @ HALF - HALF**2) / 3
"""Of a box of 1 kg about its axes [kg m^2]."""

SPEED = 1.0
"""Speed of the impact [m/s]."""

LEAVES = 0.4
"""A box that leaves with so much strikes with no other corner [m/s]."""

FLIGHT, LATER = 0.0301, 0.3 * BASE_TIMESTEP
"""Time to the impact of the first start, and how much later it is in each further one
[s]: no method has its impacts at one place within a step only."""

DURATION = 0.08
"""With 50 ms after the impact, long enough for a soft contact to part [s]."""


def bouncing_box() -> FrictionScene:
    """Returns a box that bounces once, from every start in another pose."""
    friction, restitution = 0.2, 0.7
    rows = [
        row
        for row in truth_table("box_plane")
        if (float(row["mu"]), float(row["e"])) == (friction, restitution)
        and float(row["vz1"]) > LEAVES
    ]
    size = " ".join(map(str, HALF))
    box = (
        '<geom type="plane" size="5 5 .1"/><body pos="0 0 1"><freejoint/>'
        f'<geom type="box" size="{size}" mass="1"/></body>'
    )
    return FrictionScene(
        "box",
        "box bounces off corner, edge, face: velocity after it / impact speed",
        free_bodies(box, friction),
        tuple(_before(row, FLIGHT + LATER * k) for k, row in enumerate(rows)),
        lambda motion: _outcome(
            motion.qvel[-1, :3],
            Rotation.from_quat(motion.qpos[-1, 3:], scalar_first=True),
            motion.qvel[-1, 3:],
        ),
        np.array(list(map(_true_outcome, rows))),
        friction=friction,
        restitution=restitution,
        duration=DURATION,
        speed=SPEED,
    )


def _outcome(velocity: Array, turn: Rotation, spin: Array) -> Array:
    """Returns velocity and turning over the impact speed; both stay in free flight.

    Args:
        velocity: [m/s].
        turn: From the frame of the box to that of the world.
        spin: In the frame of the box [rad/s].
    """
    # angular momentum, as a speed at the end of the box
    turning = HALF.max() * turn.apply(INERTIA * spin) / INERTIA.mean()
    return np.concatenate([velocity, turning]) / SPEED


def _true_outcome(row: dict[str, str]) -> Array:
    turn = Rotation.from_quat(numbers(row, "qw qx qy qz"), scalar_first=True)
    spin = turn.inv().apply(numbers(row, "wx1 wy1 wz1"))
    return _outcome(numbers(row, "vx1 vy1 vz1"), turn, spin)


def _before(row: dict[str, str], elapsed: float) -> tuple[Array, Array]:
    """Returns the state of a box some time before it strikes as a row says."""
    velocity, quaternion = numbers(row, "vx vy vz"), numbers(row, "qw qx qy qz")
    turn = Rotation.from_quat(quaternion, scalar_first=True)
    momentum = turn.apply(INERTIA * turn.inv().apply(numbers(row, "wx wy wz")))
    corners = (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1) * HALF
    height = -turn.apply(corners)[:, 2].min()
    earlier = free_turn(quaternion, momentum, -elapsed)
    spin = earlier.inv().apply(momentum) / INERTIA
    place = np.array([0, 0, height]) - velocity * elapsed
    qpos = np.concatenate([place, earlier.as_quat(scalar_first=True)])
    return qpos, np.concatenate([velocity, spin])


def free_turn(quaternion: Array, momentum: Array, elapsed: float) -> Rotation:
    """Returns where a box has turned that nothing acts on.

    Args:
        quaternion: At the start, (w, x, y, z).
        momentum: Angular momentum in the world, which stays [kg m^2/s].
        elapsed: Time [s], negative: back.
    """

    def rate(_: float, q: Array) -> Array:
        spin = Rotation.from_quat(q, scalar_first=True).inv().apply(momentum) / INERTIA
        w, v = q[0], q[1:]
        # q' = q (0, spin) / 2, spin in the frame of the box
        return np.concatenate([[-v @ spin], w * spin + np.cross(v, spin)]) / 2

    solved = solve_ivp(rate, (0.0, elapsed), quaternion, rtol=1e-11, atol=1e-12)
    return Rotation.from_quat(solved.y[:, -1], scalar_first=True)
