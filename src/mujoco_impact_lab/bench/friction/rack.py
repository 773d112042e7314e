"""The billiard break: fifteen balls in a rack and a cue ball, without a table."""

from __future__ import annotations

import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.friction.scene import (
    FrictionScene,
    free_bodies,
    numbers,
    truth_table,
)

BALLS = 16
RADIUS, MASS = 0.028575, 0.17
"""Of every ball [m], [kg]."""

FLIGHT = 0.1587
"""Time of the cue ball from the head spot to the rack [s]: 1.27 m."""

DURATION = 0.36
"""Until the first balls would come to the cushions [s]."""


def billiard_break() -> FrictionScene:
    """Returns the break, hit in the middle and off it."""
    rows = truth_table("rack_15")
    breaks = [rows[first : first + BALLS] for first in range(0, len(rows), BALLS)]
    speed, mu, e = numbers(rows[0], "v_cue mu e")

    def outcome(velocities: Array) -> Array:
        """Returns velocities and R x spins; their norm is RMS over the balls."""
        scaled = velocities * [1, 1, 1, RADIUS, RADIUS, RADIUS] / speed
        return np.asarray(scaled.ravel() / np.sqrt(BALLS))

    truth = np.zeros((len(breaks), BALLS, 6))
    truth[:, :, [0, 1, 5]] = [
        [numbers(row, "vx vy wz") for row in rows] for rows in breaks
    ]
    # apart, so that nothing touches before a start is set
    balls = "".join(
        f'<body pos="{ball} 0 0"><freejoint/><geom size="{RADIUS}" mass="{MASS}"/>'
        "</body>"
        for ball in range(BALLS)
    )
    return FrictionScene(
        "break",
        "billiard break, 16 balls: velocities after it / speed of the cue ball",
        free_bodies(balls, mu),
        tuple(_racked(speed, float(one[0]["offset_over_2R"])) for one in breaks),
        lambda motion: outcome(motion.qvel[-1].reshape(BALLS, 6)),
        np.array(list(map(outcome, truth))),
        friction=mu,
        restitution=e,
        duration=DURATION,
        speed=speed,
        plane=(0, 1),
    )


def _racked(speed: float, offset: float) -> tuple[Array, Array]:
    """Returns the start of a break, the cue ball off the axis by diameters."""
    qpos, qvel = np.zeros((BALLS, 7)), np.zeros((BALLS, 6))
    qpos[:, 3] = 1.0
    touching = -2 * RADIUS * np.array([np.sqrt(1 - offset**2), offset])
    qpos[0, :2] = touching - [speed * FLIGHT, 0]
    qpos[1:, :2] = [
        (row * np.sqrt(3) * RADIUS, (2 * place - row) * RADIUS)
        for row in range(5)
        for place in range(row + 1)
    ]
    qvel[0, 0] = speed
    return qpos.ravel(), qvel.ravel()
