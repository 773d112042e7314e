"""Every error this package raises, under one base class."""

from __future__ import annotations


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
    """

    def __init__(self, message: str, *, time: float) -> None:
        """Stores the message and the time [s]."""
        super().__init__(message)
        self.time = time


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
