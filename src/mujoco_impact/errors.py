"""Every error this package raises, under one base class."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mujoco_impact.comparison import Comparison
    from mujoco_impact.trajectory import Trajectory


class ImpactError(Exception):
    """Base of every error raised by `mujoco_impact`."""


class PluginError(ImpactError):
    """The engine plugin is missing, unloadable or built for another MuJoCo."""


class SceneError(ImpactError):
    """The model cannot be read, or cannot take the impact plugin as it is."""


class ConfigError(ImpactError, ValueError):
    """A setting of the impact law has an unknown name or an impossible value."""


class SimulationError(ImpactError):
    """MuJoCo reported a warning, or the state diverged, while stepping.

    Attributes:
        time: Simulated time of the first warning [s].
        trajectory: The motion until then, None if nothing was recorded.
    """

    def __init__(
        self, message: str, *, time: float, trajectory: Trajectory | None = None
    ) -> None:
        """Stores the message, the time [s] and what was recorded."""
        super().__init__(message)
        self.time = time
        self.trajectory = trajectory

    def __reduce__(self) -> tuple[Any, ...]:
        """Lets it come back from another process, without what was recorded."""
        return partial(type(self), time=self.time), self.args


class RunInterrupted(KeyboardInterrupt):
    """A run was interrupted by hand (Ctrl-C).

    Attributes:
        trajectory: The motion until then.
    """

    def __init__(self, trajectory: Trajectory) -> None:
        """Stores what was recorded."""
        super().__init__(f"interrupted at {trajectory.time[-1]:g} s")
        self.trajectory = trajectory


class ComparisonInterrupted(KeyboardInterrupt):
    """A comparison was interrupted by hand (Ctrl-C).

    Attributes:
        comparison: The results until then.
    """

    def __init__(self, comparison: Comparison) -> None:
        """Stores the results."""
        names = ", ".join(method.name for method in comparison.methods)
        super().__init__(f"interrupted after {names}")
        self.comparison = comparison


class TrajectoryError(ImpactError):
    """A trajectory file is missing, damaged or of another layout."""


class MissingExtraError(ImpactError):
    """An optional dependency is needed for what was asked."""


class ImpactWarning(UserWarning):
    """Something about an impact deserves attention but is not an error."""


class LawError(ImpactError, ValueError):
    """An impact problem has an argument out of range, or did not end."""


class ShotsError(ImpactError, ValueError):
    """Measured shots are missing, damaged, or cannot be calibrated with."""


class RenderingError(ImpactError):
    """This machine cannot draw the scene: no OpenGL, or no display for a window."""


class WorkerError(ImpactError):
    """Processes that shared the work were lost."""
