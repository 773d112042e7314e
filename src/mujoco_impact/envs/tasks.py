"""What a task is, and the tasks of the cradle, whatever library plays them.

They know neither dm_control nor gymnasium: `domain` and `gym` make environments of
them.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Protocol

import numpy as np

from mujoco_impact.envs.cradle import CradleState
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


class Task(ABC):
    """What a library needs of a task; one object plays one episode after another."""

    @abstractmethod
    def begin(self, data: Any, random: Random) -> None:
        """Sets the initial state of an episode; `data` has been reset."""

    @abstractmethod
    def after_step(self, data: Any) -> None:
        """Follows the motion; called after every control step."""

    @abstractmethod
    def observation(self, data: Any) -> dict[str, Array]:
        """Returns the observations by name, as copies."""

    @abstractmethod
    def bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of each observation, in their order."""

    @abstractmethod
    def reward(self, data: Any) -> float:
        """Returns the reward of the present state, in [0, 1]."""


class CradleTask(Task):
    """A task of a row of pendulums.

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

    def first_lifted(self, balls: int, angle: float) -> Array:
        """Returns angles [rad] with the first `balls` lifted and the others hanging."""
        return np.where(np.arange(self.state.size) < balls, -angle, 0.0)


VALUE_AT_MARGIN = 0.1
"""Reward at the margin of `tolerance`."""


def tolerance(value: float, *, low: float, high: float, margin: float) -> float:
    """Returns 1 for a value within [low, high], falling like a Gaussian outside.

    The shape is that of `dm_control.utils.rewards.tolerance`: with d the distance
    to the interval in units of the margin, exp(d² ln 0.1), which is 0.1 for d = 1.

    Args:
        value: The quantity.
        low: Lower bound of the target.
        high: Upper bound of the target; infinite for none.
        margin: Distance outside at which the reward is 0.1, > 0.
    """
    distance = max(low - value, value - high, 0.0) / margin
    return math.exp(distance**2 * math.log(VALUE_AT_MARGIN))


LOWEST_TARGET, HIGHEST_TARGET = 0.01, 0.05
"""The target height is drawn between these [m]."""

EXACT = 0.002
"""Distance to the target at which the reward is still 1 [m]."""


class Strike(CradleTask):
    """The reward is 1 while the reach of the last ball is the target height."""

    motors: ClassVar[int] = 1

    def __init__(self, state: CradleState) -> None:
        """See `CradleTask`."""
        super().__init__(state)
        self.target = LOWEST_TARGET

    def initial_angles(self, random: Random) -> Array:
        """Returns a hanging row whose first ball is a little lifted."""
        self.target = float(random.uniform(LOWEST_TARGET, HIGHEST_TARGET))
        return self.first_lifted(1, float(random.uniform(0.0, START_ANGLE)))

    def own_observation(self, data: Any) -> dict[str, Array]:  # noqa: ARG002
        """Returns the reach of the last ball and the target height [m]."""
        return {"reach": self.reach[-1:].copy(), "target": np.array([self.target])}

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns the bounds of both."""
        return {
            "reach": Bounds(1, 0.0, LARGEST["reach"]),
            "target": Bounds(1, LOWEST_TARGET, HIGHEST_TARGET),
        }

    def reward(self, data: Any) -> float:  # noqa: ARG002
        """Returns 1 within 2 mm of the target, 0.1 at half or 3/2 of it."""
        return tolerance(
            float(self.reach[-1]),
            low=self.target - EXACT,
            high=self.target + EXACT,
            margin=self.target / 2.0 - EXACT,
        )


LOWEST_START, HIGHEST_START = 0.2, 0.5
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
        return self.first_lifted(
            lifted, float(random.uniform(LOWEST_START, HIGHEST_START))
        )

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


DOMAIN = "cradle"
"""Name of the domain that the tasks belong to."""

TASKS: Mapping[str, type[CradleTask]] = MappingProxyType(
    {"strike": Strike, "damp": Damp, "select": Select}
)
"""Class of each task by its name."""
