"""Our tasks as gymnasium environments. Importing this module needs gymnasium."""

from __future__ import annotations

from typing import Any, ClassVar

import mujoco
import numpy as np

from mujoco_impact.envs.games import GAMES
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP
from mujoco_impact.errors import ConfigError, SimulationError
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array

gymnasium: Any = require("gymnasium")

RENDER_SIZE = (480, 640)
"""Height and width of a rendered frame [pixels]."""


class ImpactEnv(gymnasium.Env):  # type: ignore[misc]
    """A task with a flat observation and actions in [-1, 1].

    The observation is what the dm_control environment of the task observes, one after
    another; `observation_names` says which numbers are which.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "render_modes": ["rgb_array"],
        "render_fps": round(1.0 / CONTROL_TIMESTEP),
    }

    def __init__(
        self,
        domain: str,
        task: str,
        *,
        render_mode: str | None = None,
        **options: Any,
    ) -> None:
        """Makes the environment of one task.

        Args:
            domain: Domain of the task.
            task: Name of the task; domain and task are in `mujoco_impact.envs.GAMES`.
            render_mode: None or "rgb_array".
            **options: Options of the model and settings of the impact law, see
                `cradle_model` and `bank_model`.

        Raises:
            ConfigError: If an argument is not valid.
        """
        if (domain, task) not in GAMES:
            names = [" ".join(game) for game in GAMES]
            msg = f"there is no task {f'{domain} {task}'!r} (available: {names})"
            raise ConfigError(msg)
        modes = self.metadata["render_modes"]
        if render_mode is not None and render_mode not in modes:
            msg = f"render_mode = {render_mode!r}: allowed are None and {modes}"
            raise ConfigError(msg)
        self.render_mode = render_mode
        self.model, self._task = GAMES[domain, task](**options)
        self.data = mujoco.MjData(self.model)
        self._steps = round(CONTROL_TIMESTEP / float(self.model.opt.timestep))
        self._renderer: mujoco.Renderer | None = None
        self.observation_space, self.observation_names = self._observations()
        self.action_space = gymnasium.spaces.Box(
            -1.0, 1.0, shape=(self.model.nu,), dtype=np.float64
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begins an episode; there are no options."""
        super().reset(seed=seed, options=options)
        mujoco.mj_resetData(self.model, self.data)
        self._task.begin(self.data, self.np_random)
        mujoco.mj_forward(self.model, self.data)
        self._task.after_step(self.data)
        return self._observe(), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Applies an action for one control step; an episode has no end of its own.

        Raises:
            SimulationError: If MuJoCo gave a warning, for example on divergence.
        """
        self.data.ctrl[:] = action
        mujoco.mj_step(self.model, self.data, nstep=self._steps)
        self._check()
        self._task.after_step(self.data)
        return self._observe(), self._task.reward(self.data), False, False, {}

    def render(self) -> Any:
        """Returns a frame as seen by the first camera, or None without a mode."""
        if self.render_mode is None:
            return None
        if self._renderer is None:
            self._renderer = mujoco.Renderer(self.model, *RENDER_SIZE)
        self._renderer.update_scene(self.data, camera=0)
        return self._renderer.render()

    def close(self) -> None:
        """Closes the renderer."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def __getstate__(self) -> dict[str, Any]:
        """Returns what a copy or a pickle holds: everything but the renderer."""
        return {**self.__dict__, "_renderer": None}

    def _observations(self) -> tuple[Any, dict[str, slice]]:
        """Returns the observation space, and where each observation lies in it."""
        bounds = self._task.bounds()
        low = np.concatenate([np.full(one.size, one.low) for one in bounds.values()])
        high = np.concatenate([np.full(one.size, one.high) for one in bounds.values()])
        ends = np.cumsum([one.size for one in bounds.values()])
        names = {
            name: slice(int(end) - one.size, int(end))
            for (name, one), end in zip(bounds.items(), ends, strict=True)
        }
        return gymnasium.spaces.Box(low, high, dtype=np.float64), names

    def _observe(self) -> Array:
        """Returns the observation."""
        return np.concatenate(list(self._task.observation(self.data).values()))

    def _check(self) -> None:
        """Raises SimulationError if MuJoCo gave a warning."""
        numbers = self.data.warning.number
        if not numbers.any():
            return
        for number in np.flatnonzero(numbers):
            name = mujoco.mjtWarning(int(number)).name
            msg = f"MuJoCo gave the warning {name} by {self.data.time:.6g} s"
            raise SimulationError(msg, time=float(self.data.time))
