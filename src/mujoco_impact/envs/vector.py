"""Many environments of one task that step together. Importing this needs gymnasium.

The physics are a `mujoco.batch`, which keeps the whole state of each environment.
`mujoco.rollout` begins each call without the warm start of MuJoCo's solver, and so does
not come to the bits of single environments.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, ClassVar

import mujoco
import numpy as np
import numpy.typing as npt
from mujoco.batch import Batch

from mujoco_impact.envs.games import GAMES
from mujoco_impact.envs.gym import (
    METADATA,
    Camera,
    action_space,
    check_arguments,
    control_steps,
    observation_space,
    warning_error,
)
from mujoco_impact.envs.tasks import split
from mujoco_impact.errors import ConfigError
from mujoco_impact.extras import require
from mujoco_impact.rollouts import thread_count
from mujoco_impact.still_clock import still_clock
from mujoco_impact.trajectory import Array

gymnasium: Any = require("gymnasium")

FIELDS = ("time", "qpos", "qvel", "ctrl", "sensordata")
"""What is read and written of the data of each environment."""

Flags = npt.NDArray[np.bool_]
"""One for each environment."""

Seeds = int | Sequence[int | None] | None
"""Of the first environment, the others have the numbers after it; or of each."""


class ImpactVectorEnv(gymnasium.vector.VectorEnv):  # type: ignore[misc]
    """Environments of one task, which threads step at the same time.

    Observations, rewards, episodes and random numbers are those of `ImpactEnv` in
    gymnasium's `SyncVectorEnv`, bit for bit, on any number of threads. An episode that
    is over begins anew in the next step (`AutoresetMode.NEXT_STEP`).
    """

    metadata: ClassVar[dict[str, Any]] = {
        **METADATA,
        "autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP,
    }

    # what was not made completely has nothing to close
    closed = True

    def __init__(
        self,
        *,
        num_envs: int,
        domain: str,
        task: str,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        threads: int | None = None,
        **options: Any,
    ) -> None:
        """Makes the environments; call `gymnasium.make_vec` for it.

        Args:
            num_envs: How many environments, N.
            domain: Domain of the task.
            task: Name of the task.
            max_episode_steps: Control steps of an episode; None or -1: no end.
            render_mode: None or "rgb_array".
            threads: Number of threads; by default one for each processor.
            **options: Options of the model and settings of the impact law, see
                `cradle_model` and `bank_model`.

        Raises:
            ConfigError: If an argument is not valid.
            ValueError: If the number of threads is not positive.
        """
        check_arguments(domain, task, render_mode)
        if num_envs < 1:
            raise ConfigError(f"num_envs = {num_envs}: must be >= 1")
        self.num_envs, self.render_mode = num_envs, render_mode
        self._limit = _limit(max_episode_steps)
        # the one begins an episode, the other plays all of them
        self.model, self._one = GAMES[domain, task](**options)
        self._task = self._one.for_many(num_envs)
        self._make_spaces()
        self._batch = Batch(self.model, num_envs, thread_count(threads))
        self._data = SimpleNamespace(
            **{name: self._batch.bind(name) for name in FIELDS}
        )
        self._substeps = control_steps(self.model)
        self._random = [gymnasium.utils.seeding.np_random() for _ in range(num_envs)]
        self._steps = np.zeros(num_envs, dtype=np.int64)
        self._has_begun = np.zeros(num_envs, dtype=bool)
        self._is_over = np.zeros(num_envs, dtype=bool)
        self._camera = Camera(self.model)
        self.closed = False

    def _make_spaces(self) -> None:
        """Sets the spaces of one environment and of all."""
        batch_space = gymnasium.vector.utils.batch_space
        self.observation_names = split(self._one.bounds())
        self.single_observation_space = observation_space(self._one)
        self.single_action_space = action_space(self.model)
        self.observation_space = batch_space(
            self.single_observation_space, self.num_envs
        )
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:
        """The random number generator of each environment."""
        return tuple(random for random, _ in self._random)

    @property
    def np_random_seed(self) -> tuple[int, ...]:
        """The seed of each environment."""
        return tuple(seed for _, seed in self._random)

    def reset(
        self, *, seed: Seeds = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begins an episode in all environments, or in some.

        Args:
            seed: Seed of the first environment, i more for number i; or one for each.
                Without, random numbers go on.
            options: "reset_mask" may name the environments, bool, shape (N,).

        Returns:
            The observations, shape (N, size), and an empty dictionary.

        Raises:
            ConfigError: If an argument is not valid.
        """
        self._check_open()
        which = _reset_mask(options, self.num_envs)
        for number, one in enumerate(_seeds(seed, self.num_envs)):
            if one is not None and which[number]:
                self._random[number] = gymnasium.utils.seeding.np_random(one)
        self._begin(which)
        self._follow()
        self._has_begun |= which
        self._is_over &= ~which
        return self._task.observation(self._data), {}

    def step(
        self, actions: npt.ArrayLike
    ) -> tuple[Array, Array, Flags, Flags, dict[str, Any]]:
        """Applies an action to each environment for one control step.

        An environment whose episode is over begins another one instead, with a reward
        of 0. No episode has an end of its own but the time limit.

        Args:
            actions: In [-1, 1], shape (N, size of an action).

        Returns:
            The observations, shape (N, size), the rewards, whether an episode is
            terminated (never), whether it is truncated, shapes (N,), and an empty
            dictionary.

        Raises:
            ConfigError: If the actions have another shape.
            SimulationError: If MuJoCo gave a warning, for example on divergence.
        """
        self._check_open()
        if not self._has_begun.all():
            raise gymnasium.error.ResetNeeded("call reset before the first step")
        if np.shape(actions) != self.action_space.shape:
            msg = f"actions have shape {np.shape(actions)}, allowed: "
            raise ConfigError(f"{msg}{self.action_space.shape}")
        begins = self._is_over
        self._data.ctrl[:] = actions
        if begins.any():
            self._begin(begins)
        with still_clock():
            self._batch.step(~begins, nstep=self._substeps)
        self._check()
        self._steps[~begins] += 1
        self._follow()
        rewards: Array = self._task.reward()
        rewards[begins] = 0.0
        self._is_over = self._steps >= self._limit
        never = np.zeros(self.num_envs, dtype=bool)
        return (
            self._task.observation(self._data),
            rewards,
            never,
            self._is_over.copy(),
            {},
        )

    def render(self) -> tuple[npt.NDArray[np.uint8], ...] | None:
        """Returns a frame of each environment, or None without a mode."""
        if self.render_mode is None:
            return None
        self._check_open()
        data, frames = mujoco.MjData(self.model), []
        for number in range(self.num_envs):
            self._batch.get_data(number, data)
            mujoco.mj_forward(self.model, data)
            frames.append(self._camera.picture(data))
        return tuple(frames)

    def close_extras(self, **options: Any) -> None:  # noqa: ARG002
        """Releases the threads and the camera; options are those of other kinds."""
        self._camera.close()
        del self._batch, self._data

    def _begin(self, which: Flags) -> None:
        """Begins an episode in these environments."""
        self._batch.reset(which, stage=mujoco.mjtStage.mjSTAGE_NONE)
        for number in np.flatnonzero(which).tolist():
            row = SimpleNamespace(
                qpos=self._data.qpos[number], qvel=self._data.qvel[number]
            )
            self._one.begin(row, self._random[number][0])
            self._task.take(number, self._one)
        self._batch.forward(which)
        self._steps[which] = 0

    def _follow(self) -> None:
        """Has the task follow the motion."""
        data = self._data
        self._task.follow(data.time, list(data.qpos.T), list(data.qvel.T))

    def _check_open(self) -> None:
        """Raises ClosedEnvironmentError after `close`."""
        if self.closed:
            msg = "these environments are closed"
            raise gymnasium.error.ClosedEnvironmentError(msg)

    def _check(self) -> None:
        """Raises SimulationError if MuJoCo gave a warning."""
        # how often each was given, after what it was about
        counts = self._batch.warning[:, :, 1]
        if not counts.any():
            return
        number = int(counts.any(axis=1).argmax())
        where = f" in environment {number}"
        raise warning_error(counts[number], float(self._data.time[number]), where)


def _limit(max_episode_steps: int | None) -> float:
    """Returns how long an episode is; ConfigError if that is no length."""
    if max_episode_steps is None or max_episode_steps == -1:
        return math.inf
    if max_episode_steps < 1:
        msg = f"max_episode_steps = {max_episode_steps}: must be >= 1, or -1 for no end"
        raise ConfigError(msg)
    return max_episode_steps


def _seeds(seed: Seeds, count: int) -> Sequence[int | None]:
    """Returns the seed of each environment; ConfigError if they are not as many."""
    if seed is None:
        return [None] * count
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + number for number in range(count)]
    if len(seed) != count:
        msg = f"seed has {len(seed)} numbers, but there are {count} environments"
        raise ConfigError(msg)
    return seed


def _reset_mask(options: dict[str, Any] | None, count: int) -> Flags:
    """Returns which environments begin; ConfigError for a mask that names none."""
    mask = np.asarray((options or {}).get("reset_mask", np.ones(count, dtype=bool)))
    if mask.shape != (count,) or mask.dtype != np.bool_ or not mask.any():
        msg = f"reset_mask = {mask}: must be bool, shape ({count},), one at least true"
        raise ConfigError(msg)
    return mask
