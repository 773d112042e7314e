"""A cradle for `dm_control.composer`. Importing this module needs dm_control."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

import cradle_models
from mujoco_impact.envs.force_buffer import RATE, ForceBuffer, sample_count
from mujoco_impact.envs.mjcf import attach_mjcf
from mujoco_impact.extras import require
from mujoco_impact.sensor import NUMBERS_PER_GEOM, SensorReading, read_sensor
from mujoco_impact.settings import Setting
from mujoco_impact.trajectory import Array

composer: Any = require("dm_control.composer")
mjcf: Any = require("dm_control.mjcf")
observable: Any = require("dm_control.composer.observation.observable")


class CradleObservables(composer.Observables):  # type: ignore[misc]
    """Observables of a cradle of n balls; all are disabled until enabled.

    Those of the sensor are of the state that the last physics step started from. All
    but `force` stay until the next impact of the ball.
    """

    @composer.observable  # type: ignore[untyped-decorator]
    def angles(self) -> Any:
        """Angles of the balls [rad], shape (n,); 0: hanging."""
        return observable.MJCFFeature("qpos", self._entity.hinges)

    @composer.observable  # type: ignore[untyped-decorator]
    def speeds(self) -> Any:
        """Angular velocities of the balls [rad/s], shape (n,)."""
        return observable.MJCFFeature("qvel", self._entity.hinges)

    @composer.observable  # type: ignore[untyped-decorator]
    def force(self) -> Any:
        """Force of impacts on each ball, world frame, in a step [N], shape (n, 3)."""
        return observable.Generic(lambda physics: self._entity.reading(physics).force)

    @composer.observable  # type: ignore[untyped-decorator]
    def impulse(self) -> Any:
        """Impulse of the current or last impact of each ball [N s], shape (n,)."""
        return observable.Generic(lambda physics: self._entity.reading(physics).impulse)

    @composer.observable  # type: ignore[untyped-decorator]
    def peak_force(self) -> Any:
        """Peak force of that impact [N], shape (n,)."""
        return observable.Generic(lambda physics: self._entity.reading(physics).peak)

    @composer.observable  # type: ignore[untyped-decorator]
    def alpha(self) -> Any:
        """Alpha of that impact [-], shape (n,)."""
        return observable.Generic(lambda physics: self._entity.reading(physics).alpha)

    @composer.observable  # type: ignore[untyped-decorator]
    def impact_count(self) -> Any:
        """Impacts of each ball since the episode began, shape (n,)."""
        return observable.Generic(lambda physics: self._entity.reading(physics).count)

    @composer.observable  # type: ignore[untyped-decorator]
    def force_waveform(self) -> Any:
        """Force between neighbours at 40 kHz [N], shape (samples, n - 1)."""
        return observable.Generic(lambda _: self._entity.force_waveform())


class Cradle(composer.Entity):  # type: ignore[misc]
    """A row of n pendulums with our contacts, and observables of their impacts."""

    def _build(
        self,
        pattern: str | Sequence[cradle_models.Ball] = "AAAAA",
        *,
        length: float = 0.3,
        gap: float | Sequence[float] = 0.0,
        largest_timestep: float = 0.002,
        waveform_duration: float = 0.02,
        waveform_rate: float = RATE,
        name: str = "cradle",
        **settings: Setting,
    ) -> None:
        """Makes the entity; called by the constructor with its arguments.

        Args:
            pattern: Letters A and B of `cradle_models`, or balls (mass and radius).
            length: From the hinge to the centre of a ball [m].
            gap: Gap between neighbours at rest [m], one for all or one for each.
            largest_timestep: Physics timestep up to which impacts are seen in
                time [s].
            waveform_duration: How far `force_waveform` reaches back [s].
            waveform_rate: Sampling rate of it [Hz].
            name: Name of the PyMJCF model.
            **settings: Material and law: `restitution`, `young`, `poisson`, `law`,
                `duration` and so on, see `mujoco_impact.attach`.
        """
        xml = cradle_models.row(
            pattern, length=length, gap=gap, timestep=largest_timestep, name=name
        )
        self._root = mjcf.from_xml_string(xml)
        options: dict[str, Any] = dict(settings)
        self._sensor = attach_mjcf(self._root, **options)
        _strip(self._root)
        self._hinges = tuple(self._root.find_all("joint"))
        self._balls = tuple(self._root.find_all("geom"))
        self._waveform = (waveform_duration, waveform_rate)
        self._samples = sample_count(*self._waveform)
        self._buffer: ForceBuffer | None = None

    def _build_observables(self) -> CradleObservables:
        """Returns the observables."""
        return CradleObservables(self)

    @property
    def mjcf_model(self) -> Any:
        """The PyMJCF model."""
        return self._root

    @property
    def hinges(self) -> tuple[Any, ...]:
        """The joints, from left to right."""
        return self._hinges

    @property
    def balls(self) -> tuple[Any, ...]:
        """The geoms, from left to right."""
        return self._balls

    @property
    def sensor(self) -> Any:
        """The sensor of the plugin."""
        return self._sensor

    def set_angles(self, physics: Any, angles: npt.ArrayLike) -> None:
        """Puts the balls at rest at these angles [rad], shape (n,)."""
        joints = physics.bind(self._hinges)
        joints.qpos = np.asarray(angles, dtype=np.float64)
        joints.qvel = 0.0

    def reading(self, physics: Any) -> SensorReading:
        """Returns what the sensor says of each ball."""
        # the plugin leaves room for the tuples of other entities
        numbers = np.asarray(physics.bind(self._sensor).sensordata)
        return read_sensor(numbers[: NUMBERS_PER_GEOM * len(self._balls)])

    def force_waveform(self) -> Array:
        """Returns the force between neighbours up to now [N], (samples, n - 1)."""
        if self._buffer is None:
            return np.zeros((self._samples, len(self._balls) - 1))
        return self._buffer.read()

    def initialize_episode(self, physics: Any, random_state: Any) -> None:
        """Forgets the forces of the episode before."""
        del random_state
        duration, rate = self._waveform
        names = [ball.full_identifier for ball in self._balls]
        self._buffer = ForceBuffer(
            physics.model.ptr,
            physics.data.ptr,
            list(pairwise(names)),
            duration=duration,
            rate=rate,
        )

    def after_substep(self, physics: Any, random_state: Any) -> None:
        """Takes over the impacts of a physics step."""
        del physics, random_state
        if self._buffer is not None:
            self._buffer.poll()


def _strip(root: Any) -> None:
    """Removes what belongs to a whole scene, and clashes when models are attached."""
    for settings in (root.option, root.statistic, root.visual):
        settings.remove()
    for namespace in ("light", "texture", "key"):
        for element in root.find_all(namespace):
            element.remove()
