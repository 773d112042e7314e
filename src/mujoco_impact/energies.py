"""Potential and kinetic energy of a state."""

from __future__ import annotations

import mujoco


def find_energies(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Fills in `data.energy` [J] from the positions and velocities in `data`.

    Nothing beyond what the energies read is computed: neither contacts nor plugins.
    """
    for stage in (
        mujoco.mj_kinematics,
        mujoco.mj_comPos,
        mujoco.mj_tendon,
        mujoco.mj_makeM,
        mujoco.mj_energyPos,
        mujoco.mj_energyVel,
    ):
        stage(model, data)
