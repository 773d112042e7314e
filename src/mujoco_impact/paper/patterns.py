"""The eight three-ball patterns, run as models under the laws to be compared."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cache
from typing import Any

import mujoco
import numpy as np

import cradle_models
from mujoco_impact.calibration.synthetic import hertz_truth
from mujoco_impact.errors import ImpactWarning
from mujoco_impact.paper.printed import MEASURED, Array, printed
from mujoco_impact.runner import run
from mujoco_impact.scene import attach

RESTITUTION = 0.95
"""Of the balls; the paper does not give it. Steel at 0.5 m/s."""

FIRST_IMPACT = 0.02
"""The first impact of a row is over by then, and no ball comes back so soon [s]."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What one law makes of the first impact of a pattern.

    Attributes:
        contacts: P_12 and P_23 [N s].
        impulse: P of each ball along the row [N s], positive: away from ball 1's side.
        velocities: Velocities after the impact [m/s], if nothing else comes.
        energy: Kinetic energy after the impact, over that before.
    """

    contacts: tuple[float, float]
    impulse: Array
    velocities: Array
    energy: float


@cache
def drop_speed() -> float:
    """Returns the impact speed of the paper [m/s], which it does not print.

    Least squares of the velocity changes of table 4, the one measurement of a whole
    row, on those of the Hertz impact with e = `RESTITUTION`.
    """
    table = printed(MEASURED)
    change = table.change[:, 2] / table.masses
    truth = hertz_truth(cradle_models.balls(MEASURED), restitution=RESTITUTION)
    unit = truth.velocities - np.array([1.0, 0.0, 0.0])
    return float(change @ unit / (unit @ unit))


def run_pattern(pattern: str, *, speed: float, **settings: Any) -> Outcome:
    """Runs the model of a pattern through its first impact.

    Ball 1 touches ball 2 and has the impact speed when the run begins.

    Args:
        pattern: Letters of the balls, such as "AAB".
        speed: Impact speed [m/s].
        **settings: Settings of `attach`.
    """
    name = f"paper_{pattern.lower()}"
    spec = attach(cradle_models.model_path(name), **settings)
    model = spec.compile()
    # speed of a ball at the bottom = length of the arm times joint velocity
    arm = abs(float(model.geom("ball_1").pos[2]))
    qvel = np.zeros(model.nv)
    qvel[0] = speed / arm
    with warnings.catch_warnings():
        # what energy the equations add is told as `energy`
        warnings.simplefilter("ignore", ImpactWarning)
        motion = run(model, duration=FIRST_IMPACT, qvel=qvel)
    contacts = [0.0, 0.0]
    for impact in motion.impacts:
        left = min(int(geom.removeprefix("ball_")) for geom in impact.geoms)
        contacts[left - 1] += impact.impulse
    return _outcome(model, speed, (contacts[0], contacts[1]))


def _outcome(
    model: mujoco.MjModel, speed: float, contacts: tuple[float, float]
) -> Outcome:
    """Returns what impulses do to the balls."""
    P12, P23 = contacts
    impulse = np.array([-P12, P12 - P23, P23])
    # a ball turns with its arm: I/L² = m (1 + 2/5 r²/L²) is what an impulse meets
    arm = abs(float(model.geom("ball_1").pos[2]))
    masses = model.dof_M0 / arm**2
    start = np.array([speed, 0.0, 0.0])
    velocities = start + impulse / masses
    energy = float((masses * velocities**2).sum() / (masses * start**2).sum())
    return Outcome(contacts, impulse, velocities, energy)
