"""The row of dominoes: when does the wave come to the last one?"""

from __future__ import annotations

from functools import partial

import numpy as np

import cradle_models
from mujoco_impact.source import read_spec
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.friction.falling import Row, arrivals
from mujoco_impact_lab.bench.friction.scene import FrictionScene, Motion

STONES = 8
RESTITUTION = 0.3

PUSHES = (3.6, 3.7, 3.8, 3.9, 4.0, 4.1, 4.2, 4.3, 4.4)
"""How fast the first stone turns [rad/s]. A wave is touchy: stones rattle on their feet
when they are struck. With three pushes errors are off by a factor of five, by luck."""

ACCURACY = 8e-4
"""Of the truth: by which it changes with contacts a tenth as stiff (`falling`)."""

ARRIVED = 0.05
"""Angle by which the last stone has turned when the wave has arrived [rad]."""


def domino_row() -> FrictionScene:
    """Returns eight dominoes, the first pushed; its truth takes half a minute."""
    xml = cradle_models.dominoes(STONES)
    model = read_spec(xml).compile()
    place, push = model.key_qpos[0].copy(), model.key_qvel[0].copy()
    row = Row.of(model, RESTITUTION)
    times = arrivals(row, PUSHES, ARRIVED)
    mean = float(times.mean())
    return FrictionScene(
        "dominoes",
        "8 dominoes: time until the last one falls, relative",
        xml,
        tuple((place, push * (one / push[4])) for one in PUSHES),
        partial(_arrival, mean),
        times[:, None] / mean,
        friction=row.friction,
        restitution=RESTITUTION,
        duration=0.6,
        # of the top of a stone
        speed=row.height * float(np.mean(PUSHES)),
        plane=(0, 2),
        accuracy=ACCURACY,
    )


def _arrival(unit: float, motion: Motion) -> Array:
    """Returns when the last stone has turned by `ARRIVED`, shape (1,); never: 0."""
    w, _, y, _ = motion.qpos[:, -4:].T
    tilt = 2 * np.arctan2(y, w)
    (over,) = np.nonzero(tilt > ARRIVED)
    if not len(over):
        return np.zeros(1)
    around = slice(over[0] - 1, over[0] + 1)
    return np.array([np.interp(ARRIVED, tilt[around], motion.time[around]) / unit])
