"""Damp: bring a swinging cradle to rest by moving the first ball."""

from __future__ import annotations

from typing import Any, ClassVar

from mujoco_impact.envs.rewards import tolerance
from mujoco_impact.envs.task import Bounds, CradleTask, Random
from mujoco_impact.trajectory import Array

LOWEST, HIGHEST = 0.2, 0.5
"""The balls are lifted by an angle between these [rad]."""

REST = 1e-5
"""The reward is 1 if the balls could swing no higher than this together [m]."""

FAR = 1e-2
"""The reward is 0.1 if they could swing this high together [m]."""


class Damp(CradleTask):
    """The reward is 1 when nothing moves."""

    motors: ClassVar[int] = 1

    def initial_angles(self, random: Random) -> Array:
        """Returns a row of which all but the last ball, or fewer, are lifted."""
        lifted = int(random.uniform(1.0, self.state.size))
        return self.first_lifted(lifted, float(random.uniform(LOWEST, HIGHEST)))

    def own_observation(self, data: Any) -> dict[str, Array]:  # noqa: ARG002
        """Returns nothing: angles, speeds and impulses are all there is."""
        return {}

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns nothing, too."""
        return {}

    def reward(self, data: Any) -> float:
        """Returns 1 at rest, less the more energy there is (as a height)."""
        height = sum(self.state.heights(data))
        return tolerance(height, low=0.0, high=REST, margin=FAR - REST)
