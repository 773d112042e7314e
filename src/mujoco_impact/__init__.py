"""Impacts as force pulses of finite duration for MuJoCo.

Importing the package registers the engine plugin `mujoco_impact.waveform`. What needs
more than MuJoCo and NumPy (`calibrate`, `compare`, `envs`, `law`, `metrics`,
`reference`, `rollout`, `sensor`, `sweep`, `video`, `warp`) is imported when it is
first used.
"""

from __future__ import annotations

import importlib
from importlib import metadata
from typing import TYPE_CHECKING, Any

# before anything that imports MuJoCo: MuJoCo 4 asks for `load` while it is imported
from mujoco_impact._plugin import load, load_or_warn

load_or_warn()

from mujoco_impact import _import_hook, _put_model_guard, pickling  # noqa: E402
from mujoco_impact.errors import ImpactError, ImpactWarning  # noqa: E402
from mujoco_impact.impact import Impact  # noqa: E402
from mujoco_impact.materials import (  # noqa: E402
    MATERIALS,
    Material,
    MaterialPair,
)
from mujoco_impact.runner import run  # noqa: E402
from mujoco_impact.scene import attach, detach  # noqa: E402
from mujoco_impact.sensor import read_sensor, sensor_slice  # noqa: E402
from mujoco_impact.settings import SETTINGS  # noqa: E402
from mujoco_impact.trajectory import Trajectory  # noqa: E402

if TYPE_CHECKING:
    from mujoco_impact import (
        calibration,
        envs,
        law,
        metrics,
        reference,
        sensor,
        video,
    )
    from mujoco_impact import warp as warp
    from mujoco_impact.calibration import Calibration, calibrate
    from mujoco_impact.comparing.compare import Comparison, compare
    from mujoco_impact.rollouts import Rollouts, rollout
    from mujoco_impact.sweeping.sweep import Sweep, sweep

    __version__: str

__all__ = [
    "MATERIALS",
    "SETTINGS",
    "Calibration",
    "Comparison",
    "Impact",
    "ImpactError",
    "ImpactWarning",
    "Material",
    "MaterialPair",
    "Rollouts",
    "Sweep",
    "Trajectory",
    "__version__",
    "attach",
    "calibrate",
    "calibration",
    "compare",
    "detach",
    "envs",
    "law",
    "load",
    "metrics",
    "read_sensor",
    "reference",
    "rollout",
    "run",
    "sensor",
    "sensor_slice",
    "sweep",
    "video",
]

_MODULES = (
    "calibration",
    "envs",
    "law",
    "metrics",
    "reference",
    "sensor",
    "video",
    # not in __all__: without its extra `from mujoco_impact import *` would fail
    "warp",
)
_MEMBERS = {
    "Calibration": "calibration",
    "Comparison": "comparing.compare",
    "Rollouts": "rollouts",
    "Sweep": "sweeping.sweep",
    "calibrate": "calibration",
    "compare": "comparing.compare",
    "rollout": "rollouts",
    "sweep": "sweeping.sweep",
}


def __dir__() -> list[str]:
    """Returns all names, those that are imported when they are used included."""
    return sorted({*globals(), *__all__, *_MODULES})


def __getattr__(name: str) -> Any:
    """Imports the parts that are not needed to run a scene."""
    if name == "__version__":
        return metadata.version("mujoco-impact")
    if name in _MODULES:
        return importlib.import_module(f"mujoco_impact.{name}")
    if name in _MEMBERS:
        # no module has the name of a function: importing it would hide the function
        module = importlib.import_module(f"mujoco_impact.{_MEMBERS[name]}")
        globals()[name] = getattr(module, name)
        return globals()[name]
    raise AttributeError(f"module 'mujoco_impact' has no attribute {name!r}")


pickling.enable()

# gymnasium has no entry points for environments: this makes ours known to it
_import_hook.when_imported(
    "gymnasium", lambda _: importlib.import_module("mujoco_impact.envs")
)
for _engine in _put_model_guard.GUARDED:
    _import_hook.when_imported(_engine, _put_model_guard.guard)
