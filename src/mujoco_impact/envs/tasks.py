"""What a task is, and the tasks of the cradle, whatever library plays them.

They know neither dm_control nor gymnasium: `domain` and `gym` make environments of
them.
"""

from __future__ import annotations

import copy
import functools
import itertools
import math
import operator
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Protocol

import numpy as np

from mujoco_impact.envs.arithmetic import Number, tolerance, where
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


@dataclass(frozen=True)
class Source:
    """Numbers of `mjData` that are observed as they are.

    Attributes:
        field: Name of the array.
        index: Which of its numbers.
    """

    field: str
    index: slice


class Task(ABC):
    """What a library needs of a task; one object plays one episode after another.

    It plays in one environment, or in many at once, see `for_many`. An observation
    consists of numbers from the arrays of `mjData`, and then of numbers `in_mind`.
    """

    sources: tuple[Source, ...]
    """The first part of an observation."""

    memory: tuple[str, ...]
    """Attributes that are kept from step to step: numbers, or lists of numbers."""

    @abstractmethod
    def begin(self, data: Any, random: Random) -> None:
        """Sets the initial state of an episode; `data` has been reset."""

    @abstractmethod
    def follow(
        self, time: Number, qpos: Sequence[Number], qvel: Sequence[Number]
    ) -> None:
        """Follows the motion; called after `begin` and after every control step.

        A second call in the same state changes nothing.

        Args:
            time: The time since the start [s].
            qpos: All positions.
            qvel: All velocities.
        """

    @abstractmethod
    def reward(self) -> Number:
        """Returns the reward of the state followed last, in [0, 1]."""

    @abstractmethod
    def in_mind(self) -> list[Number]:
        """Returns the second part of an observation."""

    @abstractmethod
    def bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of each observation, in their order."""

    def after_step(self, data: Any) -> None:
        """Follows the motion that `mjData` have come to."""
        self.follow(data.time, data.qpos.tolist(), data.qvel.tolist())

    def observation(self, data: Any) -> Array:
        """Returns the observations one after another, as a copy.

        Args:
            data: `mjData`, or its arrays with an axis of environments in front.
        """
        parts = [getattr(data, one.field)[..., one.index] for one in self.sources]
        numbers = self.in_mind()
        if numbers:
            parts.append(np.array(numbers).T)
        return np.concatenate(parts, axis=-1)

    def for_many(self, count: int) -> Task:
        """Returns the task for as many environments, whose numbers are arrays."""
        many = copy.copy(self)
        for name in self.memory:
            found = getattr(self, name)
            if isinstance(found, list):
                setattr(many, name, [np.full(count, one) for one in found])
            else:
                setattr(many, name, np.full(count, found))
        return many

    def take(self, number: int, one: Task) -> None:
        """Takes for one of many environments what a task of one environment keeps."""
        for name in self.memory:
            mine, other = getattr(self, name), getattr(one, name)
            if not isinstance(mine, list):
                mine, other = [mine], [other]
            for array, value in zip(mine, other, strict=True):
                array[number] = value


def split(bounds: Mapping[str, Bounds]) -> dict[str, slice]:
    """Returns where the observations lie that follow one another."""
    ends = itertools.accumulate(one.size for one in bounds.values())
    return {
        name: slice(end - one.size, end)
        for (name, one), end in zip(bounds.items(), ends, strict=True)
    }


class CradleTask(Task):
    """A task of a row of pendulums.

    The *reach* of a ball is how high it swung on the far side (towards the last
    ball) the last time, or is about to swing: its energy as a height [m], held while
    it is not out. It is forgotten when the last ball leaves the row anew.
    """

    memory: tuple[str, ...] = ("reach", "was_out")

    motors: ClassVar[int]
    """How many balls, from the left, have a motor."""

    def __init__(self, state: CradleState) -> None:
        """Takes the view of the model that the task is played on."""
        self.state = state
        self.heights: list[Number] = []
        self.reach: list[Number] = [0.0] * state.size
        self.was_out: Number = False
        self.sources = (Source("qpos", slice(None)), Source("qvel", slice(None)))
        if state.impulses is not None:
            self.sources += (Source("sensordata", state.impulses),)

    def begin(self, data: Any, random: Random) -> None:
        """Sets the initial state of an episode; `data` has been reset."""
        self.reach = [0.0] * self.state.size
        self.was_out = False
        self.state.place(data, self.initial_angles(random))

    def follow(
        self,
        time: Number,  # noqa: ARG002
        qpos: Sequence[Number],
        qvel: Sequence[Number],
    ) -> None:
        """Follows how far the balls swing out; see `Task`."""
        self.heights = self.state.heights(qpos, qvel)
        is_out = qpos[-1] > OUT_ANGLE
        # 0 when the last ball leaves, and all are forgotten, otherwise 1
        kept = 1 - (is_out > self.was_out)
        self.was_out = is_out
        self.reach = [
            where(angle > OUT_ANGLE, height, kept * reach)
            for angle, height, reach in zip(qpos, self.heights, self.reach, strict=True)
        ]

    def bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of each observation, in their order."""
        names = ("angles", "speeds", "impulses")[: len(self.sources)]
        n = self.state.size
        common = {name: Bounds(n, -LARGEST[name], LARGEST[name]) for name in names}
        return {**common, **self.own_bounds()}

    @abstractmethod
    def initial_angles(self, random: Random) -> Array:
        """Returns where the balls are let go [rad], and draws what else is random."""

    @abstractmethod
    def own_bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of what is `in_mind`."""

    def first_lifted(self, balls: int, angle: float) -> Array:
        """Returns angles [rad] with the first `balls` lifted and the others hanging."""
        return np.where(np.arange(self.state.size) < balls, -angle, 0.0)


LOWEST_TARGET, HIGHEST_TARGET = 0.01, 0.05
"""The target height is drawn between these [m]."""

EXACT = 0.002
"""Distance to the target at which the reward is still 1 [m]."""


class Strike(CradleTask):
    """The reward is 1 while the reach of the last ball is the target height."""

    memory = (*CradleTask.memory, "target")

    motors: ClassVar[int] = 1

    def __init__(self, state: CradleState) -> None:
        """See `CradleTask`."""
        super().__init__(state)
        self.target: Number = LOWEST_TARGET

    def initial_angles(self, random: Random) -> Array:
        """Returns a hanging row whose first ball is a little lifted."""
        self.target = float(random.uniform(LOWEST_TARGET, HIGHEST_TARGET))
        return self.first_lifted(1, float(random.uniform(0.0, START_ANGLE)))

    def in_mind(self) -> list[Number]:
        """Returns the reach of the last ball and the target height [m]."""
        return [self.reach[-1], self.target]

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns the bounds of both."""
        return {
            "reach": Bounds(1, 0.0, LARGEST["reach"]),
            "target": Bounds(1, LOWEST_TARGET, HIGHEST_TARGET),
        }

    def reward(self) -> Number:
        """Returns 1 within 2 mm of the target, 0.1 at half or 3/2 of it."""
        return tolerance(
            self.reach[-1],
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

    def in_mind(self) -> list[Number]:
        """Returns nothing: angles, speeds and impulses are all there is."""
        return []

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns nothing, too."""
        return {}

    def reward(self) -> Number:
        """Returns 1 at rest, less the more energy there is (as a height)."""
        # one after another: `sum` may add floats and arrays differently
        height = functools.reduce(operator.add, self.heights)
        return tolerance(height, low=0.0, high=REST, margin=FAR - REST)


OUT_HEIGHT = 0.005
"""A ball is sent out if it reaches this height [m]."""

STAY_HEIGHT = 0.002
"""A ball stays if it reaches no more than this height [m]."""


REQUEST_TIME = 5.0
"""After this time, and again after it, another number of balls is wanted [s]."""


class Select(CradleTask):
    """The reward is 1 while exactly the last n balls reached the height of 5 mm."""

    memory = (*CradleTask.memory, "requests")

    motors: ClassVar[int] = 3

    def __init__(self, state: CradleState) -> None:
        """See `CradleTask`."""
        super().__init__(state)
        self.requests: list[Number] = [1.0, 2.0]
        self.wanted: Number = 1.0

    def initial_angles(self, random: Random) -> Array:
        """Returns a hanging row whose first ball is a little lifted."""
        first = int(random.uniform(0.0, self.motors))
        # another one than the first
        second = first + 1 + int(random.uniform(0.0, self.motors - 1))
        self.requests = [1.0 + first, 1.0 + second % self.motors]
        return self.first_lifted(1, float(random.uniform(0.0, START_ANGLE)))

    def follow(
        self, time: Number, qpos: Sequence[Number], qvel: Sequence[Number]
    ) -> None:
        """Looks how many balls are wanted now."""
        super().follow(time, qpos, qvel)
        is_first = time / REQUEST_TIME % 2.0 < 1.0
        self.wanted = where(is_first, *self.requests)

    def in_mind(self) -> list[Number]:
        """Returns the reach of every ball [m] and the number wanted."""
        return [*self.reach, self.wanted]

    def own_bounds(self) -> dict[str, Bounds]:
        """Returns the bounds of both."""
        return {
            "reach": Bounds(self.state.size, 0.0, LARGEST["reach"]),
            "wanted": Bounds(1, 1.0, float(self.motors)),
        }

    def reward(self) -> Number:
        """Returns the product over all balls of how well each does its part."""
        sent, stayed = [], []
        for ball, reach in enumerate(self.reach):
            is_wanted = ball >= self.state.size - self.wanted
            value = tolerance(
                reach,
                low=where(is_wanted, OUT_HEIGHT, 0.0),
                high=where(is_wanted, math.inf, STAY_HEIGHT),
                margin=where(is_wanted, OUT_HEIGHT / 2, STAY_HEIGHT),
            )
            sent.append(where(is_wanted, value, 1.0))
            stayed.append(where(is_wanted, 1.0, value))
        return math.prod(sent + stayed)


DOMAIN = "cradle"
"""Name of the domain that the tasks belong to."""

TASKS: Mapping[str, type[CradleTask]] = MappingProxyType(
    {"strike": Strike, "damp": Damp, "select": Select}
)
"""Class of each task by its name."""
