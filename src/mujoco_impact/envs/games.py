"""Every task of this package: what it is called, and how its model is made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import mujoco

from mujoco_impact.envs import billiards, tasks
from mujoco_impact.envs.billiards import BankShot, bank_model
from mujoco_impact.envs.cradle import CradleState, cradle_model
from mujoco_impact.envs.tasks import TASKS, Task

Game = Callable[..., tuple[mujoco.MjModel, Task]]
"""Makes a model, and a task that is played on it, from the options of the model."""


def _cradle(task: str, **options: Any) -> tuple[mujoco.MjModel, Task]:
    """Returns a cradle, see `cradle_model`, and its task."""
    model = cradle_model(motors=TASKS[task].motors, **options)
    return model, TASKS[task](CradleState(model))


def _bank(**options: Any) -> tuple[mujoco.MjModel, Task]:
    """Returns a pool table, see `bank_model`, and its task."""
    model = bank_model(**options)
    return model, BankShot(model)


GAMES: Mapping[tuple[str, str], Game] = MappingProxyType(
    {
        **{(tasks.DOMAIN, task): partial(_cradle, task) for task in TASKS},
        (billiards.DOMAIN, "bank"): _bank,
    }
)
"""Every environment of this package by domain and task."""
