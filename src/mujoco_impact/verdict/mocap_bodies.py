"""Bodies that the user moves by hand: MuJoCo's mocap bodies, and what is fixed to them.

MuJoCo takes them for still, and counts their weight in the potential energy of a scene,
although nothing that it knows lifts them.
"""

from __future__ import annotations

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.encounters import Numbers
from mujoco_impact.verdict.step_log import StepLog

MOST_TURN = 1.0
"""Turn in one step from which on a body was put there and did not move [rad]."""


def mocap_bodies(model: mujoco.MjModel) -> Numbers:
    """Returns the ids of the mocap bodies and of all that is fixed to them."""
    return np.flatnonzero(model.body_mocapid[model.body_weldid] >= 0)


def potential(model: mujoco.MjModel, data: mujoco.MjData, bodies: Numbers) -> float:
    """Returns what bodies add to the potential energy that MuJoCo counts [J]."""
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY:
        return 0.0
    height = data.xipos[bodies] @ model.opt.gravity
    return -float(model.body_mass[bodies] @ height)


class MocapMotion:
    """Velocities of mocap bodies, from pose to pose, as the plugin takes them.

    Attributes:
        bodies: Ids of the mocap bodies and of all that is fixed to them.
        needs: What of `mjData` must be logged after each step.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        """Finds the bodies."""
        self.bodies = mocap_bodies(model)
        self.needs = ("mocap_pos", "mocap_quat") if model.nmocap else ()
        self._rate = 1.0 / float(model.opt.timestep)
        self._mocap = model.body_mocapid[model.body_weldid[self.bodies]]
        self._roots = model.body_rootid[self.bodies]
        # what goes farther than its size in a step was put there and did not move
        width = np.where(
            model.geom_rbound > 0, 2 * model.geom_rbound, model.stat.extent
        )
        carrier = model.body_mocapid[model.body_weldid[model.geom_bodyid]]
        self._sizes = np.array(
            [width[carrier == one].max(initial=0.0) for one in range(model.nmocap)]
        )
        self._last: tuple[Array, Array] | None = None

    def velocities(self, log: StepLog) -> Array:
        """Returns `cvel` of the logged steps, with that of mocap bodies.

        Shape (steps, nbody, 6). Each log must follow the one before; in the first step
        of all every mocap body is still.
        """
        cvel = log["cvel"]
        if not self.bodies.size:
            return cvel
        position, quaternion = log["mocap_pos"].copy(), log["mocap_quat"].copy()
        length = np.linalg.norm(quaternion, axis=-1, keepdims=True)
        quaternion /= np.maximum(length, 1e-300)
        before = self._last or (position[0], quaternion[0])
        self._last = position[-1], quaternion[-1]
        shift = np.diff(position, axis=0, prepend=before[0][None])
        turn = _turns(np.concatenate([before[1][None], quaternion]))
        moved = np.linalg.norm(shift, axis=-1) <= self._sizes
        moved &= np.linalg.norm(turn, axis=-1) <= MOST_TURN
        speed, spin = (
            (self._rate * np.where(moved[..., None], way, 0.0))[:, self._mocap]
            for way in (shift, turn)
        )
        # at the centre that cvel is about
        arm = log["subtree_com"][:, self._roots] - position[:, self._mocap]
        cvel = cvel.copy()
        cvel[:, self.bodies, :3] = spin
        cvel[:, self.bodies, 3:] = speed + np.cross(spin, arm)
        return cvel


def _turns(quaternion: Array) -> Array:
    """Returns the turns between unit quaternions that follow each other [rad].

    Args:
        quaternion: Shape (steps + 1, n, 4).

    Returns:
        Rotation vectors in the frame of the world, shape (steps, n, 3).
    """
    old, new = quaternion[:-1], quaternion[1:]
    # new times the inverse of old
    real = (old * new).sum(axis=-1)
    axis = old[..., :1] * new[..., 1:] - new[..., :1] * old[..., 1:]
    axis -= np.cross(new[..., 1:], old[..., 1:])
    sine = np.linalg.norm(axis, axis=-1)
    angle = 2.0 * np.arctan2(sine, np.abs(real)) * np.where(real < 0, -1.0, 1.0)
    turns: Array = axis * (angle / np.maximum(sine, 1e-300))[..., None]
    return turns
