"""More pulses under way than the state has slots for."""

import math

import mujoco
import numpy as np
import pytest

import mujoco_impact
from mujoco_impact.errors import ImpactWarning

BALLS = 12
DISTANCE = 0.0606  # of the centres: 0.6 mm before they touch


def star(duration: float | str) -> mujoco.MjModel:
    """A heavy ball, and twelve that all come at it in the same step.

    The instance owns the heavy ball alone, so it has 4 x 1 + 2 slots.
    """
    angles = [2 * math.pi * i / BALLS for i in range(BALLS)]
    places = [(DISTANCE * math.cos(a), DISTANCE * math.sin(a)) for a in angles]
    bodies = "".join(
        f'<body pos="{x!r} {y!r} 0"><freejoint/><geom size=".01" mass=".01"/></body>'
        for x, y in places
    )
    xml = f"""
    <mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody>
      <body><freejoint/><geom name="hub" size=".05" mass="1"/></body>{bodies}
    </worldbody></mujoco>"""
    return mujoco_impact.attach(
        xml, geoms=["hub"], duration=duration, depth=0.004, gap=0.01
    ).compile()


def velocities(model: mujoco.MjModel) -> np.ndarray:
    """Towards the middle, one of them faster."""
    data = mujoco.MjData(model)
    centre = data.qpos.reshape(-1, 7)[1:, :3]
    qvel = np.zeros((BALLS + 1, 6))
    qvel[1:, :3] = -centre / DISTANCE * 0.3
    qvel[1] *= 1.01
    return qvel


def test_pulses_without_a_slot_are_delivered_at_once_and_lose_nothing():
    model = star(duration=0.02)
    qvel = velocities(model)
    with pytest.warns(ImpactWarning, match="6 impacts have no record"):
        motion = mujoco_impact.run(model, duration=0.06, qvel=qvel.ravel())
    assert len(motion.impacts) + motion.missed_impacts == BALLS
    mass = model.body_mass[1:]
    after = motion.qvel.reshape(len(motion.time), -1, 6)[:, :, :3]
    p = np.einsum("i,kij->kj", mass, after)
    # rounding of twelve impulses
    assert np.abs(p - p[0]).max() < 1e-14
    energy = np.einsum("i,kij,kij->k", mass, after, after) / 2
    # the law's answer, whenever it is delivered, but for the turning of the lines of
    # centres while the pulses last
    assert energy[-1] == pytest.approx(energy[0], rel=1e-5)
