"""Our tasks as domains of dm_control's suite.

Like the modules in `dm_control.suite` a domain has `SUITE`, the functions that make its
environments; `register_suite` adds ours to the suite itself. Importing this module
needs dm_control.
"""

from __future__ import annotations

import collections
from collections.abc import Callable, Mapping
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np

from mujoco_impact.envs import tasks
from mujoco_impact.envs.games import GAMES
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, TIME_LIMIT
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array

mujoco: Any = require("dm_control.mujoco")
core: Any = require("dm_control.mujoco.wrapper.core")
control: Any = require("dm_control.rl.control")
base: Any = require("dm_control.suite.base")
containers: Any = require("dm_control.utils.containers")


class Physics(mujoco.Physics):  # type: ignore[misc]
    """Physics of our tasks.

    A copy or a pickle steps as the original does: dm_control's own loses what the
    environment has set, and goes on with legacy steps.
    """

    legacy_step: bool = False

    def __getstate__(self) -> tuple[Any, bool]:
        """Returns model, state and the way of stepping."""
        return super().__getstate__(), self.legacy_step

    def __setstate__(self, state: tuple[Any, bool]) -> None:
        """Takes what `__getstate__` returned."""
        data, self.legacy_step = state
        super().__setstate__(data)

    def copy(self, share_model: bool = False) -> Physics:
        """Returns a copy; see `dm_control.mujoco.Physics.copy`."""
        twin: Physics = super().copy(share_model=share_model)
        twin.legacy_step = self.legacy_step
        return twin


class Task(base.Task):  # type: ignore[misc]
    """A task as dm_control wants it."""

    def __init__(self, rules: tasks.Task, random: Any = None) -> None:
        """Takes the task.

        Args:
            rules: What is played.
            random: Seed or `numpy.random.RandomState`.
        """
        super().__init__(random=random)
        self.rules = rules
        self._names = tasks.split(rules.bounds())

    def initialize_episode(self, physics: Any) -> None:
        """Draws the initial state of an episode."""
        self.rules.begin(physics.data, self.random)
        super().initialize_episode(physics)

    def after_step(self, physics: Any) -> None:
        """Follows the motion, and shows the reward if asked to."""
        self.rules.after_step(physics.data)
        super().after_step(physics)

    def get_observation(self, physics: Any) -> collections.OrderedDict[str, Array]:
        """Returns the observations by name."""
        found = self.rules.observation(physics.data)
        return collections.OrderedDict(
            {name: found[at] for name, at in self._names.items()}
        )

    def get_reward(self, physics: Any) -> float:  # noqa: ARG002
        """Returns the reward of the state after the last step, in [0, 1]."""
        return float(np.clip(self.rules.reward(), 0.0, 1.0))


def environment(
    domain: str,
    task: str,
    *,
    time_limit: float = TIME_LIMIT,
    random: Any = None,
    environment_kwargs: dict[str, Any] | None = None,
    **options: Any,
) -> Any:
    """Returns the dm_control environment of one task.

    Args:
        domain: Domain of the task.
        task: Name of the task, see `GAMES`.
        time_limit: Length of an episode [s].
        random: Seed or `numpy.random.RandomState`.
        environment_kwargs: Arguments of `dm_control.rl.control.Environment`.
        **options: Options of the model and settings of the impact law, see
            `cradle_model` and `bank_model`.
    """
    model, rules = GAMES[domain, task](**options)
    physics = Physics.from_model(core.MjModel(model))
    # what dm_control calls legacy steps splits a step in two, with forces of one
    # position and contacts of the next in between
    kwargs = {"legacy_step": False, **(environment_kwargs or {})}
    return control.Environment(
        physics,
        Task(rules, random=random),
        time_limit=time_limit,
        control_timestep=CONTROL_TIMESTEP,
        **kwargs,
    )


def _factory(domain: str, task: str) -> Callable[..., Any]:
    """Returns the function that makes the environment of a task."""

    def make(**options: Any) -> Any:
        return environment(domain, task, **options)

    # the name under which `SUITE` has it
    make.__name__ = task
    return make


def _domains() -> dict[str, Any]:
    """Returns what the suite takes for the module of each domain."""
    found: dict[str, Any] = {}
    for domain, task in GAMES:
        empty = SimpleNamespace(SUITE=containers.TaggedTasks())
        suite = found.setdefault(domain, empty).SUITE
        suite.add("benchmarking")(_factory(domain, task))
    return found


DOMAINS: Mapping[str, Any] = MappingProxyType(_domains())
"""Our domains by name; each has `SUITE`, as the modules of dm_control's suite."""
