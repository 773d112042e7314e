"""The tasks of the cradle by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from mujoco_impact.envs.damp import Damp
from mujoco_impact.envs.select_balls import Select
from mujoco_impact.envs.strike import Strike
from mujoco_impact.envs.task import CradleTask

DOMAIN = "cradle"
"""Name of the domain that the tasks belong to."""

TASKS: Mapping[str, type[CradleTask]] = MappingProxyType(
    {"strike": Strike, "damp": Damp, "select": Select}
)
"""Class of each task by its name."""
