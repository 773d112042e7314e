"""What a panel of a video shows: a motion with its impacts, read at any time."""

from __future__ import annotations

import dataclasses
from typing import Any

import mujoco
import numpy as np

from mujoco_impact.comparing.pendulums import PendulumRow
from mujoco_impact.impact import Impact
from mujoco_impact.reference import ReferenceTrajectory
from mujoco_impact.trajectory import Array, Trajectory


@dataclasses.dataclass(frozen=True, eq=False)
class Panel:
    """One motion of a scene, side by side with others.

    Attributes:
        caption: Text above it.
        time: Times of the samples [s], shape (n_samples,).
        qpos: Positions at these times, shape (n_samples, nq).
        impacts: Impacts to draw, if any.
    """

    caption: str
    time: Array
    qpos: Array
    impacts: tuple[Impact, ...] = ()

    @classmethod
    def of(cls, motion: Trajectory, caption: str) -> Panel:
        """Returns the panel of a run."""
        return cls(caption, motion.time, motion.qpos, motion.impacts)

    @classmethod
    def of_reference(
        cls, reference: ReferenceTrajectory, row: PendulumRow, motion: Trajectory
    ) -> Panel:
        """Returns the panel of a reference, at the times of a run of the row."""
        qpos = np.zeros_like(motion.qpos)
        qpos[:, row.dofs] = reference(motion.time)[0] * row.signs
        return cls("Hertz reference", motion.time, qpos)

    def at(self, model: mujoco.MjModel, time: float) -> Array:
        """Returns the positions at a time between two samples, shape (nq,)."""
        after = int(np.searchsorted(self.time, time))
        if after == 0 or after == len(self.time):
            outer: Array = self.qpos[min(after, len(self.time) - 1)]
            return outer
        start, end = self.qpos[after - 1], self.qpos[after]
        step = float(self.time[after] - self.time[after - 1])
        rates: Array = np.zeros(model.nv)
        mujoco.mj_differentiatePos(model, rates, step, start, end)
        # of rotations, too, which are not interpolated number by number
        qpos: Array = start.copy()
        mujoco.mj_integratePos(model, qpos, rates, time - self.time[after - 1])
        return qpos


def place(model: mujoco.MjModel, data: Any, qpos: Array) -> None:
    """Puts the bodies where positions say, with all that a picture needs."""
    data.qpos[:] = qpos
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)
    mujoco.mj_flex(model, data)
    mujoco.mj_tendon(model, data)
