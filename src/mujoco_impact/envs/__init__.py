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

from mujoco_impact.envs.cradle_model import cradle_model
from mujoco_impact.envs.extras import is_installed
from mujoco_impact.envs.force_buffer import ForceBuffer
from mujoco_impact.envs.registration import environment_id, register_gymnasium
from mujoco_impact.envs.tasks import DOMAIN, TASKS

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

_WITH_DM_CONTROL = {
    "Cradle": "cradle_entity",
    "attach_mjcf": "mjcf",
    "load": "suite",
    "register_suite": "suite",
}

if is_installed("gymnasium"):
    register_gymnasium()


def __getattr__(name: str) -> Any:
    """Imports what needs dm_control when it is first used."""
    if name not in _WITH_DM_CONTROL:
        raise AttributeError(f"module 'mujoco_impact.envs' has no attribute {name!r}")
    module = importlib.import_module(f"mujoco_impact.envs.{_WITH_DM_CONTROL[name]}")
    return getattr(module, name)
