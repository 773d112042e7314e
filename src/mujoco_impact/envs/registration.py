"""Names of the cradle environments in gymnasium. Importing this module needs nothing.

gymnasium makes an environment by the place of its class, so that `gym.py`, which needs
gymnasium, is imported when the first environment is made.
"""

from __future__ import annotations

from mujoco_impact.envs.extras import require
from mujoco_impact.envs.task import CONTROL_TIMESTEP, TIME_LIMIT
from mujoco_impact.envs.tasks import TASKS

NAMESPACE = "mujoco_impact"


def environment_id(task: str) -> str:
    """Returns the id of a task, such as "mujoco_impact/CradleStrike-v0"."""
    return f"{NAMESPACE}/Cradle{task.capitalize()}-v0"


def register_gymnasium() -> None:
    """Registers the tasks with gymnasium; does nothing if they are registered.

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
