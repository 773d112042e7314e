"""The cradle as a domain of dm_control's suite.

Like the modules in `dm_control.suite` it has `SUITE`, a `Physics` and a function for
each task; `register_suite` adds it to the suite itself. Importing this module needs
dm_control.
"""

from __future__ import annotations

import collections
from typing import Any

import numpy as np

from mujoco_impact.envs.cradle import Contacts, CradleState, cradle_model
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, TASKS, TIME_LIMIT
from mujoco_impact.extras import require
from mujoco_impact.settings import Setting
from mujoco_impact.trajectory import Array

mujoco: Any = require("dm_control.mujoco")
core: Any = require("dm_control.mujoco.wrapper.core")
control: Any = require("dm_control.rl.control")
base: Any = require("dm_control.suite.base")
containers: Any = require("dm_control.utils.containers")

SUITE = containers.TaggedTasks()
"""Factories of the tasks by name, as in every domain of the suite."""


class Physics(mujoco.Physics):  # type: ignore[misc]
    """Physics of the cradle.

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
    """A `CradleTask` as dm_control wants it."""

    def __init__(self, name: str, state: CradleState, random: Any = None) -> None:
        """Makes the task of that name.

        Args:
            name: One of `TASKS`.
            state: View of the model of the physics.
            random: Seed or `numpy.random.RandomState`.
        """
        super().__init__(random=random)
        self.cradle_task = TASKS[name](state)

    def initialize_episode(self, physics: Any) -> None:
        """Draws the initial state of an episode."""
        self.cradle_task.begin(physics.data, self.random)
        super().initialize_episode(physics)

    def after_step(self, physics: Any) -> None:
        """Follows the motion, and shows the reward if asked to."""
        self.cradle_task.after_step(physics.data)
        super().after_step(physics)

    def get_observation(self, physics: Any) -> collections.OrderedDict[str, Array]:
        """Returns the observations by name."""
        found = self.cradle_task.observation(physics.data)
        return collections.OrderedDict(found)

    def get_reward(self, physics: Any) -> float:
        """Returns the reward in [0, 1]."""
        return float(np.clip(self.cradle_task.reward(physics.data), 0.0, 1.0))


def environment(
    name: str,
    *,
    pattern: str = "AAAAA",
    contacts: Contacts = "impact",
    time_limit: float = TIME_LIMIT,
    random: Any = None,
    environment_kwargs: dict[str, Any] | None = None,
    **settings: Setting,
) -> Any:
    """Returns the dm_control environment of one task.

    Args:
        name: One of `TASKS`.
        pattern: Balls of the row, see `cradle_model`.
        contacts: Whose contacts the balls have.
        time_limit: Length of an episode [s].
        random: Seed or `numpy.random.RandomState`.
        environment_kwargs: Arguments of `dm_control.rl.control.Environment`.
        **settings: Settings of the impact law.
    """
    model = cradle_model(
        pattern, motors=TASKS[name].motors, contacts=contacts, **settings
    )
    physics = Physics.from_model(core.MjModel(model))
    # what dm_control calls legacy steps splits a step in two, with forces of one
    # position and contacts of the next in between
    options = {"legacy_step": False, **(environment_kwargs or {})}
    return control.Environment(
        physics,
        Task(name, CradleState(model), random=random),
        time_limit=time_limit,
        control_timestep=CONTROL_TIMESTEP,
        **options,
    )


@SUITE.add("benchmarking")  # type: ignore[untyped-decorator]
def strike(**options: Any) -> Any:
    """Returns the task `strike`; options are those of `environment`."""
    return environment("strike", **options)


@SUITE.add("benchmarking")  # type: ignore[untyped-decorator]
def damp(**options: Any) -> Any:
    """Returns the task `damp`; options are those of `environment`."""
    return environment("damp", **options)


@SUITE.add("benchmarking")  # type: ignore[untyped-decorator]
def select(**options: Any) -> Any:
    """Returns the task `select`; options are those of `environment`."""
    return environment("select", **options)
