"""The settings of the plugin's instances, as the plugin itself reads them."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache
from typing import Any

import mujoco

from mujoco_impact._plugin import load, plugin_path
from mujoco_impact.errors import PluginError, SceneError

_NUMBERS = ("restitution", "effective_modulus", "touch", "tolerance")
_FLAGS = ("hertz", "bistiffness", "instant", "passive", "frictionless", "plain")

FINEST = 1e-6
"""The smallest `tolerance` that single precision can keep."""


class _Layout(ctypes.Structure):
    """`SettingsForOthers` of plugin/engine/scene/settings_api.cc."""

    _fields_ = (
        *((name, ctypes.c_double) for name in _NUMBERS),
        *((name, ctypes.c_int) for name in _FLAGS),
    )


@dataclass(frozen=True)
class Settings:
    """Settings of one instance.

    Attributes:
        restitution: e of every contact [-].
        effective_modulus: E* of two bodies [Pa].
        touch: Gaps up to this count as touching [m].
        tolerance: Error of a step of the law, relative [-].
        frictionless: Whether a setting leaves tangential impulses out.
    """

    restitution: float
    effective_modulus: float
    touch: float
    tolerance: float
    frictionless: bool


def read_settings(model: mujoco.MjModel, instance: int) -> Settings:
    """Returns the settings of an instance.

    Raises:
        SceneError: If one is not supported on Warp.
        PluginError: If the library of the plugin is of another version.
    """
    layout = _Layout()
    size = ctypes.sizeof(layout)
    if not _function()(model._address, instance, ctypes.byref(layout), size):
        msg = (
            f"{plugin_path()} is of another version than mujoco_impact.warp: its "
            f"settings are not {size} bytes; build the two from the same sources"
        )
        raise PluginError(msg)
    refused = {
        "law = 'calibrated'": not layout.hertz,
        "dissipation = 'viscous'": not layout.bistiffness,
        "duration other than 'hertz'": not layout.instant,
        "passive = 'false'": not layout.passive,
        "materials": not layout.plain,
        f"tolerance = {layout.tolerance:g} below {FINEST:g}": layout.tolerance < FINEST,
    }
    for what, is_so in refused.items():
        if is_so:
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_PLUGIN, instance)
            msg = (
                f"mujoco_impact.warp does not support {what}, of the instance {name!r}"
            )
            raise SceneError(msg)
    return Settings(
        restitution=layout.restitution,
        effective_modulus=layout.effective_modulus,
        touch=layout.touch,
        tolerance=layout.tolerance,
        frictionless=bool(layout.frictionless),
    )


@cache
def _function() -> Any:
    """Returns the function of the plugin library."""
    load()
    function = ctypes.CDLL(str(plugin_path())).mujoco_impact_settings
    function.argtypes = (
        ctypes.c_void_p,
        ctypes.c_int,
        ctypes.POINTER(_Layout),
        ctypes.c_size_t,
    )
    function.restype = ctypes.c_int
    return function
