"""What can be observed of a cradle entity. Importing this module needs dm_control."""

from __future__ import annotations

from typing import Any

from mujoco_impact.envs.extras import require

composer: Any = require("dm_control.composer")
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
