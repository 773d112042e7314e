"""Select: send as many balls out on the far side as asked for."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from mujoco_impact.envs.cradle_state import CradleState
from mujoco_impact.envs.rewards import tolerance
from mujoco_impact.envs.task import LARGEST, START_ANGLE, Bounds, CradleTask, Random
from mujoco_impact.trajectory import Array

OUT_HEIGHT = 0.005
"""A ball is sent out if it reaches this height [m]."""

STAY_HEIGHT = 0.002
"""A ball stays if it reaches no more than this height [m]."""


REQUEST_TIME = 5.0
"""After this time, and again after it, another number of balls is wanted [s]."""


class Select(CradleTask):
    """The reward is 1 while exactly the last n balls reached the height of 5 mm."""

    motors: ClassVar[int] = 3

    def __init__(self, state: CradleState) -> None:
        """See `CradleTask`."""
        super().__init__(state)
        self._requests = (1, 2)

    def initial_angles(self, random: Random) -> Array:
        """Returns a hanging row whose first ball is a little lifted."""
        first = int(random.uniform(0.0, self.motors))
        # another one than the first
        second = first + 1 + int(random.uniform(0.0, self.motors - 1))
        self._requests = (1 + first, 1 + second % self.motors)
        return self.first_lifted(1, float(random.uniform(0.0, START_ANGLE)))

    def wanted(self, data: Any) -> int:
        """Returns how many balls are wanted now."""
        turn = int(data.time / REQUEST_TIME)
        return self._requests[turn % len(self._requests)]

    def own_observation(self, data: Any) -> dict[str, Array]:
        """Returns the reach of every ball [m] and the number wanted."""
        wanted = np.array([float(self.wanted(data))])
        return {"reach": self.reach.copy(), "wanted": wanted}

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns the bounds of both."""
        return {
            "reach": Bounds(self.state.size, 0.0, LARGEST["reach"]),
            "wanted": Bounds(1, 1.0, float(self.motors)),
        }

    def reward(self, data: Any) -> float:
        """Returns the product over all balls of how well each does its part."""
        wanted = self.wanted(data)
        out, stay = self.reach[-wanted:], self.reach[:-wanted]
        sent = [
            tolerance(float(reach), low=OUT_HEIGHT, high=np.inf, margin=OUT_HEIGHT / 2)
            for reach in out
        ]
        stayed = [
            tolerance(float(reach), low=0.0, high=STAY_HEIGHT, margin=STAY_HEIGHT)
            for reach in stay
        ]
        return float(np.prod(sent + stayed))
