"""Our tasks as gymnasium environments. Importing this module needs gymnasium."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact.envs.games import GAMES
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, Task, split
from mujoco_impact.errors import ConfigError, SimulationError
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array

gymnasium: Any = require("gymnasium")

RENDER_SIZE = (480, 640)
"""Height and width of a rendered frame [pixels]."""

METADATA: Mapping[str, Any] = MappingProxyType(
    {"render_modes": ["rgb_array"], "render_fps": round(1.0 / CONTROL_TIMESTEP)}
)
"""What gymnasium has to know of an environment."""


def check_arguments(domain: str, task: str, render_mode: str | None) -> None:
    """Raises ConfigError if there is no such task, or it cannot be rendered so."""
    if (domain, task) not in GAMES:
        names = [" ".join(game) for game in GAMES]
        msg = f"there is no task {f'{domain} {task}'!r} (available: {names})"
        raise ConfigError(msg)
    modes = METADATA["render_modes"]
    if render_mode is not None and render_mode not in modes:
        msg = f"render_mode = {render_mode!r}: allowed are None and {modes}"
        raise ConfigError(msg)


def observation_space(task: Task) -> Any:
    """Returns the space of the observations of one environment."""
    bounds = task.bounds().values()
    low = np.concatenate([np.full(one.size, one.low) for one in bounds])
    high = np.concatenate([np.full(one.size, one.high) for one in bounds])
    return gymnasium.spaces.Box(low, high, dtype=np.float64)


def action_space(model: mujoco.MjModel) -> Any:
    """Returns the space of the actions of one environment."""
    return gymnasium.spaces.Box(-1.0, 1.0, shape=(model.nu,), dtype=np.float64)


def control_steps(model: mujoco.MjModel) -> int:
    """Returns how many steps of physics a control step has."""
    return round(CONTROL_TIMESTEP / float(model.opt.timestep))


def warning_error(
    numbers: npt.NDArray[np.int32], time: float, where: str = ""
) -> SimulationError:
    """Returns the error for how often MuJoCo gave each of its warnings."""
    name = mujoco.mjtWarning(int(np.flatnonzero(numbers)[0])).name
    msg = f"MuJoCo gave the warning {name}{where} by {time:.6g} s"
    return SimulationError(msg, time=time)


class Camera:
    """Takes pictures as seen by the first camera of a model."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Takes the model; OpenGL is needed from the first picture on."""
        self._model = model
        self._renderer: mujoco.Renderer | None = None

    def picture(self, data: mujoco.MjData) -> npt.NDArray[np.uint8]:
        """Returns a picture, shape (height, width, 3)."""
        if self._renderer is None:
            self._renderer = mujoco.Renderer(self._model, *RENDER_SIZE)
        self._renderer.update_scene(data, camera=0)
        picture: npt.NDArray[np.uint8] = self._renderer.render()
        return picture

    def close(self) -> None:
        """Releases what OpenGL holds; another picture takes it again."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def __getstate__(self) -> dict[str, Any]:
        """Returns what a copy or a pickle holds: everything but the renderer."""
        return {**self.__dict__, "_renderer": None}


class ImpactEnv(gymnasium.Env):  # type: ignore[misc]
    """A task with a flat observation and actions in [-1, 1].

    The observation is what the dm_control environment of the task observes, one after
    another; `observation_names` says which numbers are which.
    """

    metadata: ClassVar[dict[str, Any]] = dict(METADATA)

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
        check_arguments(domain, task, render_mode)
        self.render_mode = render_mode
        self.model, self._task = GAMES[domain, task](**options)
        self.data = mujoco.MjData(self.model)
        self._steps = control_steps(self.model)
        self._camera = Camera(self.model)
        self.observation_names = split(self._task.bounds())
        self.observation_space = observation_space(self._task)
        self.action_space = action_space(self.model)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begins an episode; there are no options."""
        super().reset(seed=seed, options=options)
        mujoco.mj_resetData(self.model, self.data)
        self._task.begin(self.data, self.np_random)
        mujoco.mj_forward(self.model, self.data)
        self._task.after_step(self.data)
        return self._task.observation(self.data), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Applies an action for one control step; an episode has no end of its own.

        Raises:
            SimulationError: If MuJoCo gave a warning, for example on divergence.
        """
        self.data.ctrl[:] = action
        mujoco.mj_step(self.model, self.data, nstep=self._steps)
        self._check()
        self._task.after_step(self.data)
        observation = self._task.observation(self.data)
        return observation, self._task.reward(), False, False, {}

    def render(self) -> Any:
        """Returns a frame as seen by the first camera, or None without a mode."""
        if self.render_mode is None:
            return None
        return self._camera.picture(self.data)

    def close(self) -> None:
        """Closes the camera."""
        self._camera.close()

    def _check(self) -> None:
        """Raises SimulationError if MuJoCo gave a warning."""
        numbers = self.data.warning.number
        # a tenth of the time of `numbers.any()`
        if any(numbers.tolist()):
            raise warning_error(numbers, float(self.data.time))
