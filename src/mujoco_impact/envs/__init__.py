"""Impacts inside dm_control and gymnasium environments.

`load` makes an environment of dm_control's suite with our contacts: the domains
`cradle` and `billiards` with the tasks of `ALL_TASKS`, or any of its own.
`attach_mjcf` gives our contacts to a PyMJCF model, `Cradle` is an entity for
`dm_control.composer`. Importing this package registers the tasks with gymnasium if that
is installed, as `mujoco_impact/CradleStrike-v0` and so on. dm_control is imported when
it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from mujoco_impact.envs.billiards import bank_model
from mujoco_impact.envs.cradle import cradle_model
from mujoco_impact.envs.force_buffer import ForceBuffer
from mujoco_impact.envs.games import GAMES
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, TIME_LIMIT
from mujoco_impact.extras import is_installed, require

if TYPE_CHECKING:
    from mujoco_impact.envs.cradle_entity import Cradle
    from mujoco_impact.envs.mjcf import attach_mjcf
    from mujoco_impact.envs.suite import load, register_suite

__all__ = [
    "ALL_TASKS",
    "Cradle",
    "ForceBuffer",
    "attach_mjcf",
    "bank_model",
    "cradle_model",
    "environment_id",
    "load",
    "register_gymnasium",
    "register_suite",
]

ALL_TASKS = tuple(GAMES)
"""Domain and task of every environment of this package."""

NAMESPACE = "mujoco_impact"
"""Of the environments in gymnasium."""

_WITH_DM_CONTROL = {
    "Cradle": "cradle_entity",
    "attach_mjcf": "mjcf",
    "load": "suite",
    "register_suite": "suite",
}


def environment_id(domain: str, task: str) -> str:
    """Returns the id of a task, such as "mujoco_impact/CradleStrike-v0"."""
    return f"{NAMESPACE}/{domain.capitalize()}{task.capitalize()}-v0"


def register_gymnasium() -> None:
    """Registers the tasks with gymnasium; does nothing if they are registered.

    gymnasium makes an environment by the place of its class, so that `gym` and
    `vector`, which need it, are imported when the first environment is made.

    Raises:
        MissingExtraError: If gymnasium is not installed.
    """
    gymnasium = require("gymnasium")
    for domain, task in ALL_TASKS:
        name = environment_id(domain, task)
        if name in gymnasium.registry:
            continue
        gymnasium.register(
            id=name,
            entry_point="mujoco_impact.envs.gym:ImpactEnv",
            vector_entry_point="mujoco_impact.envs.vector:ImpactVectorEnv",
            max_episode_steps=round(TIME_LIMIT / CONTROL_TIMESTEP),
            kwargs={"domain": domain, "task": task},
        )


def __getattr__(name: str) -> Any:
    """Imports what needs dm_control when it is first used."""
    if name not in _WITH_DM_CONTROL:
        raise AttributeError(f"module 'mujoco_impact.envs' has no attribute {name!r}")
    module = importlib.import_module(f"mujoco_impact.envs.{_WITH_DM_CONTROL[name]}")
    return getattr(module, name)


if is_installed("gymnasium"):
    register_gymnasium()
