"""Impacts as force pulses of finite duration for MuJoCo.

Importing the package registers the engine plugin `mujoco_impact.waveform`. What needs
more than MuJoCo and NumPy (`calibrate`, `compare`, `envs`, `law`, `metrics`,
`reference`, `rollout`, `sensor`, `video`) is imported when it is first used.
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING, Any

# before anything that imports MuJoCo: MuJoCo 4 asks for `load` while it is imported
from mujoco_impact._plugin import load, load_or_warn

load_or_warn()

from mujoco_impact import pickling  # noqa: E402
from mujoco_impact.errors import ImpactError  # noqa: E402
from mujoco_impact.impact import Impact  # noqa: E402
from mujoco_impact.runner import run  # noqa: E402
from mujoco_impact.scene import attach  # noqa: E402
from mujoco_impact.trajectory import Trajectory  # noqa: E402

if TYPE_CHECKING:
    from mujoco_impact import calibration, envs, law, metrics, reference, sensor, video
    from mujoco_impact.calibration import Calibration, calibrate
    from mujoco_impact.compare import Comparison, compare
    from mujoco_impact.rollouts import Rollouts, rollout

__all__ = [
    "Calibration",
    "Comparison",
    "Impact",
    "ImpactError",
    "Rollouts",
    "Trajectory",
    "attach",
    "calibrate",
    "calibration",
    "compare",
    "envs",
    "law",
    "load",
    "metrics",
    "reference",
    "rollout",
    "run",
    "sensor",
    "video",
]

_MODULES = ("calibration", "envs", "law", "metrics", "reference", "sensor", "video")
_MEMBERS = {
    "Calibration": "calibration",
    "Comparison": "compare",
    "Rollouts": "rollouts",
    "calibrate": "calibration",
    "compare": "compare",
    "rollout": "rollouts",
}


def __getattr__(name: str) -> Any:
    """Imports the parts that are not needed to run a scene."""
    if name in _MODULES:
        return importlib.import_module(f"mujoco_impact.{name}")
    if name in _MEMBERS:
        source = _MEMBERS[name]
        module = importlib.import_module(f"mujoco_impact.{source}")
        # the function, not the module of the same name, is what users mean
        members = [key for key in _MEMBERS if _MEMBERS[key] == source]
        globals().update({key: getattr(module, key) for key in members})
        return globals()[name]
    raise AttributeError(f"module 'mujoco_impact' has no attribute {name!r}")


pickling.enable()

# gymnasium has no way to find environments on its own; it is not imported for this
if "gymnasium" in sys.modules:
    importlib.import_module("mujoco_impact.envs")
