"""What the tasks see of a cradle: angles, speeds, heights and impulses."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from mujoco_impact.sensor import IMPULSE, NUMBERS_PER_GEOM, sensor_slice
from mujoco_impact.trajectory import Array


class CradleState:
    """A row of pendulums of `cradle_model`, read from and written to `mjData`.

    Attributes:
        size: Number of balls, n.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        """Takes what stays the same from the model.

        Args:
            model: The model; `mjData` is given to each method, because an environment
                may replace it.
        """
        self.size = int(model.njnt)
        self._length: Array = np.linalg.norm(model.body_ipos[1:], axis=1)
        gravity = float(-model.opt.gravity[2])
        # I / (2 m g): height that an angular velocity is worth [m s²]
        self._swing: Array = model.dof_M0 / (2.0 * model.body_mass[1:] * gravity)
        self._impulses: slice | None = None
        if model.nsensor > 0:
            all_numbers = sensor_slice(model)
            self._impulses = slice(
                all_numbers.start + IMPULSE, all_numbers.stop, NUMBERS_PER_GEOM
            )

    @property
    def has_impacts(self) -> bool:
        """Whether the model has the plugin, and so a sensor of impacts."""
        return self._impulses is not None

    def angles(self, data: Any) -> Array:
        """Returns the angles [rad], shape (n,); 0: hanging, > 0: towards the last."""
        return np.array(data.qpos)

    def speeds(self, data: Any) -> Array:
        """Returns the angular velocities [rad/s], shape (n,)."""
        return np.array(data.qvel)

    def impulses(self, data: Any) -> Array:
        """Returns the impulse of the last impact of each ball [N s], shape (n,)."""
        return np.array(data.sensordata[self._impulses])

    def heights(self, data: Any) -> Array:
        """Returns how high each ball would swing if nothing met it [m], shape (n,).

        Above its lowest point, from the energy of the pendulum:
        h = L (1 - cos θ) + I ω² / (2 m g).
        """
        return np.asarray(
            self._length * (1.0 - np.cos(data.qpos)) + self._swing * data.qvel**2
        )

    def place(self, data: Any, angles: Array) -> None:
        """Puts the balls at rest at these angles [rad], shape (n,)."""
        data.qpos[:] = angles
        data.qvel[:] = 0.0
