"""What the tasks see of a cradle: angles, speeds, heights and impulses."""

from __future__ import annotations

import math
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
        self._length: list[float] = np.linalg.norm(model.body_ipos[1:], axis=1).tolist()
        gravity = float(-model.opt.gravity[2])
        # I / (2 m g): height that an angular velocity is worth [m s²]
        swing = model.dof_M0 / (2.0 * model.body_mass[1:] * gravity)
        self._swing: list[float] = swing.tolist()
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

    def height(self, ball: int, angle: float, speed: float) -> float:
        """Returns how high a ball would swing if nothing met it [m].

        Above its lowest point, from the energy of the pendulum:
        h = L (1 - cos θ) + I ω² / (2 m g).

        Args:
            ball: Number of the ball, from 0.
            angle: θ [rad].
            speed: ω [rad/s].
        """
        swing = self._swing[ball] * speed * speed
        return self._length[ball] * (1.0 - math.cos(angle)) + swing

    def heights(self, data: Any) -> list[float]:
        """Returns `height` of every ball [m]."""
        # a few numbers: plain floats are several times faster than arrays
        angles, speeds = data.qpos.tolist(), data.qvel.tolist()
        return list(map(self.height, range(self.size), angles, speeds))

    def place(self, data: Any, angles: Array) -> None:
        """Puts the balls at rest at these angles [rad], shape (n,)."""
        data.qpos[:] = angles
        data.qvel[:] = 0.0
