"""Impacts inside dm_control and gymnasium environments.

`load` makes an environment of dm_control's suite with our contacts: the domain
`cradle` with the tasks of `ALL_TASKS`, or any of its own. `attach_mjcf` gives our
contacts to a PyMJCF model, `Cradle` is an entity for `dm_control.composer`.
Importing this package registers the tasks with gymnasium if that is installed, as
`mujoco_impact/CradleStrike-v0` and so on. dm_control is imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from mujoco_impact.envs.cradle import cradle_model
from mujoco_impact.envs.force_buffer import ForceBuffer
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, DOMAIN, TASKS, TIME_LIMIT
from mujoco_impact.extras import is_installed, require

if TYPE_CHECKING:
    from mujoco_impact.envs.cradle_entity import Cradle
    from mujoco_impact.envs.mjcf import attach_mjcf
    from mujoco_impact.envs.suite import load, register_suite

__all__ = [
    "ALL_TASKS",
    "TASKS",
    "Cradle",
    "ForceBuffer",
    "attach_mjcf",
    "cradle_model",
    "environment_id",
    "load",
    "register_gymnasium",
    "register_suite",
]

ALL_TASKS = tuple((DOMAIN, task) for task in TASKS)
"""Domain and task of every environment of this package."""

NAMESPACE = "mujoco_impact"
"""Of the environments in gymnasium."""

_WITH_DM_CONTROL = {
    "Cradle": "cradle_entity",
    "attach_mjcf": "mjcf",
    "load": "suite",
    "register_suite": "suite",
}


def environment_id(task: str) -> str:
    """Returns the id of a task, such as "mujoco_impact/CradleStrike-v0"."""
    return f"{NAMESPACE}/Cradle{task.capitalize()}-v0"


def register_gymnasium() -> None:
    """Registers the tasks with gymnasium; does nothing if they are registered.

    gymnasium makes an environment by the place of its class, so that `gym`, which needs
    it, is imported when the first environment is made.

    Raises:
        MissingExtraError: If gymnasium is not installed.
    """
    gymnasium = require("gymnasium")
    for task in TASKS:
        if environment_id(task) in gymnasium.registry:
            continue
        gymnasium.register(
            id=environment_id(task),
            entry_point="mujoco_impact.envs.gym:CradleEnv",
            max_episode_steps=round(TIME_LIMIT / CONTROL_TIMESTEP),
            kwargs={"task": task},
        )


def __getattr__(name: str) -> Any:
    """Imports what needs dm_control when it is first used."""
    if name not in _WITH_DM_CONTROL:
        raise AttributeError(f"module 'mujoco_impact.envs' has no attribute {name!r}")
    module = importlib.import_module(f"mujoco_impact.envs.{_WITH_DM_CONTROL[name]}")
    return getattr(module, name)


if is_installed("gymnasium"):
    register_gymnasium()
