"""What every task of the cradle has in common, whatever library runs it.

A task knows neither dm_control nor gymnasium: `domain.py` and `gym.py` make
environments of it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np

from mujoco_impact.envs.cradle_state import CradleState
from mujoco_impact.trajectory import Array

CONTROL_TIMESTEP = 0.02
"""Time between two actions [s]."""

TIME_LIMIT = 10.0
"""Length of an episode [s]."""

OUT_ANGLE = 0.02
"""Beyond this angle a ball counts as being out on the far side [rad]."""

START_ANGLE = 0.1
"""Balls that are not at rest at the start are lifted by up to this angle [rad]."""

LARGEST = {"angles": 2.0, "speeds": 50.0, "impulses": 10.0, "reach": 0.7}
"""Bounds of the observations that all tasks have: no motion of the model exceeds
them. [rad], [rad/s], [N s], [m]"""


class Random(Protocol):
    """What a task needs of `numpy.random.Generator` or `RandomState`."""

    def uniform(self, low: float, high: float) -> Any:
        """Returns a number in [low, high)."""


@dataclass(frozen=True)
class Bounds:
    """Size and bounds of one observation."""

    size: int
    low: float
    high: float


class CradleTask(ABC):
    """A task of a row of pendulums; one object plays one episode after another.

    The *reach* of a ball is how high it swung on the far side (towards the last
    ball) the last time, or is about to swing: its energy as a height [m], held while
    it is not out. It is forgotten when the last ball leaves the row anew.
    """

    motors: ClassVar[int]
    """How many balls, from the left, have a motor."""

    def __init__(self, state: CradleState) -> None:
        """Takes the view of the model that the task is played on."""
        self.state = state
        self.reach: Array = np.zeros(state.size)
        self._was_out = False

    def begin(self, data: Any, random: Random) -> None:
        """Sets the initial state of an episode; `data` has been reset."""
        self.reach = np.zeros(self.state.size)
        self._was_out = False
        self.state.place(data, self.initial_angles(random))

    def after_step(self, data: Any) -> None:
        """Follows how far the balls swing out; called after every control step."""
        angles = data.qpos.tolist()
        is_out = angles[-1] > OUT_ANGLE
        if is_out and not self._was_out:
            self.reach = np.zeros(self.state.size)
        self._was_out = is_out
        for ball, angle in enumerate(angles):
            if angle > OUT_ANGLE:
                speed = float(data.qvel[ball])
                self.reach[ball] = self.state.height(ball, angle, speed)

    def observation(self, data: Any) -> dict[str, Array]:
        """Returns the observations by name, as copies."""
        found = {
            "angles": self.state.angles(data),
            "speeds": self.state.speeds(data),
        }
        if self.state.has_impacts:
            found["impulses"] = self.state.impulses(data)
        return {**found, **self.own_observation(data)}

    def bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of each observation, in their order."""
        names = ["angles", "speeds"] + ["impulses"] * self.state.has_impacts
        n = self.state.size
        common = {name: Bounds(n, -LARGEST[name], LARGEST[name]) for name in names}
        return {**common, **self.own_bounds()}

    @abstractmethod
    def initial_angles(self, random: Random) -> Array:
        """Returns where the balls are let go [rad], and draws what else is random."""

    @abstractmethod
    def own_observation(self, data: Any) -> dict[str, Array]:
        """Returns the observations that only this task has."""

    @abstractmethod
    def own_bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of `own_observation`."""

    @abstractmethod
    def reward(self, data: Any) -> float:
        """Returns the reward of the present state, in [0, 1]."""

    def first_lifted(self, balls: int, angle: float) -> Array:
        """Returns angles [rad] with the first `balls` lifted and the others hanging."""
        return np.where(np.arange(self.state.size) < balls, -angle, 0.0)
