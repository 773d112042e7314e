"""Impacts as force pulses of finite duration for MuJoCo.

Importing the package registers the engine plugin `mujoco_impact.waveform`. What needs
more than MuJoCo and NumPy (`compare`, `law`, `metrics`, `reference`) is imported when
it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

# before anything that imports MuJoCo: MuJoCo 4 asks for `load` while it is imported
from mujoco_impact._plugin import load, load_or_warn

load_or_warn()

from mujoco_impact.errors import ImpactError  # noqa: E402
from mujoco_impact.runner import run  # noqa: E402
from mujoco_impact.scene import attach  # noqa: E402
from mujoco_impact.trajectory import Impact, Trajectory  # noqa: E402

if TYPE_CHECKING:
    from mujoco_impact import calibration, law, metrics, reference
    from mujoco_impact.calibration import Calibration, calibrate
    from mujoco_impact.compare import Comparison, compare

__all__ = [
    "Calibration",
    "Comparison",
    "Impact",
    "ImpactError",
    "Trajectory",
    "attach",
    "calibrate",
    "calibration",
    "compare",
    "law",
    "load",
    "metrics",
    "reference",
    "run",
]

_MODULES = ("calibration", "law", "metrics", "reference")
_MEMBERS = {
    "Calibration": "calibration",
    "Comparison": "compare",
    "calibrate": "calibration",
    "compare": "compare",
}


def __getattr__(name: str) -> Any:
    """Imports the parts that are not needed to run a scene."""
    if name in _MODULES:
        return importlib.import_module(f"mujoco_impact.{name}")
    if name in _MEMBERS:
        module = importlib.import_module(f"mujoco_impact.{_MEMBERS[name]}")
        # the function, not the module of the same name, is what users mean
        globals().update(
            {key: getattr(module, key)
             for key, home in _MEMBERS.items() if home == _MEMBERS[name]}
        )  # fmt: skip
        return globals()[name]
    raise AttributeError(f"module 'mujoco_impact' has no attribute {name!r}")
