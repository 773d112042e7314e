"""Strike: bring the last ball to a target height by moving the first."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from mujoco_impact.envs.cradle_state import CradleState
from mujoco_impact.envs.rewards import tolerance
from mujoco_impact.envs.task import LARGEST, START_ANGLE, Bounds, CradleTask, Random
from mujoco_impact.trajectory import Array

LOWEST, HIGHEST = 0.01, 0.05
"""The target height is drawn between these [m]."""

EXACT = 0.002
"""Distance to the target at which the reward is still 1 [m]."""


class Strike(CradleTask):
    """The reward is 1 while the reach of the last ball is the target height."""

    motors: ClassVar[int] = 1

    def __init__(self, state: CradleState) -> None:
        """See `CradleTask`."""
        super().__init__(state)
        self.target = LOWEST

    def initial_angles(self, random: Random) -> Array:
        """Returns a hanging row whose first ball is a little lifted."""
        self.target = float(random.uniform(LOWEST, HIGHEST))
        return self.first_lifted(1, float(random.uniform(0.0, START_ANGLE)))

    def own_observation(self, data: Any) -> dict[str, Array]:  # noqa: ARG002
        """Returns the reach of the last ball and the target height [m]."""
        return {"reach": self.reach[-1:].copy(), "target": np.array([self.target])}

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns the bounds of both."""
        return {
            "reach": Bounds(1, 0.0, LARGEST["reach"]),
            "target": Bounds(1, LOWEST, HIGHEST),
        }

    def reward(self, data: Any) -> float:  # noqa: ARG002
        """Returns 1 within 2 mm of the target, 0.1 at half or 3/2 of it."""
        return tolerance(
            float(self.reach[-1]),
            low=self.target - EXACT,
            high=self.target + EXACT,
            margin=self.target / 2.0 - EXACT,
        )
