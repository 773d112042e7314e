"""Environments that are not ours, each twice: with our contacts and as they are."""

from __future__ import annotations

import dataclasses
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mujoco_impact import attach, envs
from mujoco_impact.errors import ImpactWarning
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array

suite: Any = require("dm_control.suite")
control: Any = require("dm_control.rl.control")
gymnasium: Any = require("gymnasium")

DM_CONTROL, GYMNASIUM = "dm_control", "gymnasium"


@dataclasses.dataclass(frozen=True)
class Player:
    """One environment, to be played.

    Attributes:
        model: Its model.
        data: The data that it steps.
        reset: Begins an episode with a seed.
        step: Takes an action of shape (nu,), in [-1, 1].
        substeps: Steps of the physics that an action lasts.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    reset: Callable[[int], None]
    step: Callable[[Array], None]
    substeps: int

    def control(self, action: Array) -> Array:
        """Returns the controls of an action in [-1, 1], shape (nu,)."""
        low, high = self.model.actuator_ctrlrange.T
        limited = self.model.actuator_ctrllimited.astype(bool)
        return np.where(limited, low + (high - low) * (action + 1) / 2, action)


@dataclasses.dataclass(frozen=True)
class Scene:
    """An environment by library, domain and task; `task` is empty in gymnasium."""

    library: str
    domain: str
    task: str

    @property
    def name(self) -> str:
        """What it is called in tables."""
        return f"{self.domain} {self.task}".strip()

    def stock(self) -> Player:
        """Returns the environment as it is."""
        if self.library == GYMNASIUM:
            return _of_gymnasium(gymnasium.make(self.domain))
        options = {"environment_kwargs": {"legacy_step": False}}
        return _of_suite(
            lambda seed: suite.load(
                self.domain, self.task, task_kwargs={"random": seed}, **options
            )
        )

    def ours(self, restitution: float) -> Player:
        """Returns it with the contacts of all geoms ours.

        Args:
            restitution: Of these contacts, in [0, 1].

        Raises:
            ImpactError: If it cannot take the plugin.
        """
        with warnings.catch_warnings():
            # what force sensors miss is told when the scene is loaded, and not judged
            warnings.simplefilter("ignore", ImpactWarning)
            if self.library == GYMNASIUM:
                return _of_gymnasium(self._with_impacts(restitution))
            return _of_suite(
                lambda seed: envs.load(
                    self.domain,
                    self.task,
                    task_kwargs={"random": seed},
                    restitution=restitution,
                )
            )

    def _with_impacts(self, restitution: float) -> Any:
        """Returns the environment of gymnasium with our contacts."""
        path = gymnasium.make(self.domain).unwrapped.fullpath
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "scene.xml"
            xml = attach(path, restitution=restitution).to_xml()
            file.write_text(xml, encoding="utf-8")
            return gymnasium.make(self.domain, xml_file=str(file))


def scenes_of_suite() -> Iterator[Scene]:
    """All tasks of dm_control's suite."""
    for domain, tasks in suite.TASKS_BY_DOMAIN.items():
        for task in tasks:
            yield Scene(DM_CONTROL, domain, task)


def scenes_of_gymnasium() -> Iterator[Scene]:
    """The newest versions of gymnasium's environments of MuJoCo."""
    for name in sorted(gymnasium.registry):
        entry = str(gymnasium.registry[name].entry_point)
        if entry.startswith("gymnasium.envs.mujoco") and name.endswith("-v5"):
            yield Scene(GYMNASIUM, name, "")


def _of_suite(load: Callable[[int], Any]) -> Player:
    """Returns the player of an environment of dm_control."""
    environment = load(0)
    physics, task = environment.physics, environment.task
    low, high = environment.action_spec().minimum, environment.action_spec().maximum

    def reset(seed: int) -> None:
        task.random.seed(seed)
        environment.reset()

    def step(action: Array) -> None:
        try:
            last = environment.step(low + (high - low) * (action + 1) / 2).last()
        except control.PhysicsError:
            # of a warning, which is counted
            last = True
        if last:
            environment.reset()

    substeps = round(environment.control_timestep() / physics.timestep())
    return Player(physics.model.ptr, physics.data.ptr, reset, step, substeps)


def _of_gymnasium(wrapped: Any) -> Player:
    """Returns the player of an environment of gymnasium."""
    environment = wrapped.unwrapped
    low, high = environment.action_space.low, environment.action_space.high

    def reset(seed: int) -> None:
        environment.reset(seed=seed)

    def step(action: Array) -> None:
        if environment.step(low + (high - low) * (action + 1) / 2)[2]:
            environment.reset()

    return Player(
        environment.model, environment.data, reset, step, environment.frame_skip
    )
