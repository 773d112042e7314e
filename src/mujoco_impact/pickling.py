"""Models and data that carry the plugin, in other processes.

MuJoCo's own pickle of a model that needs a plugin ends in a segmentation fault where
the plugin is not registered. So what is pickled with ours refers to this module,
which unpickling imports, and with it the package that registers the plugin. Where the
package is not installed, Python says so.
"""

from __future__ import annotations

import copyreg
from typing import Any

import mujoco
import numpy as np

from mujoco_impact import _plugin
from mujoco_impact.errors import PluginError
from mujoco_impact.pulses import plugin_number


def enable() -> None:
    """Makes pickles of models and data safe that carry the plugin."""
    copyreg.pickle(mujoco.MjModel, _reduce_model)
    copyreg.pickle(mujoco.MjData, _reduce_data)


def restore(kind: Any, state: Any, number: int, version: str) -> Any:
    """Returns the model or the data of a pickle; called by unpickling.

    Args:
        kind: `mujoco.MjModel` or `mujoco.MjData`.
        state: What MuJoCo pickles of it.
        number: Number under which the plugin was registered where it was pickled.
        version: Version of MuJoCo there.

    Raises:
        PluginError: If the plugin cannot be loaded, or MuJoCo would take another
            plugin for ours.
    """
    _plugin.load()
    running = mujoco.mj_versionString()
    if version != running:
        msg = f"pickled with MuJoCo {version}, which {running} cannot read"
        raise PluginError(msg)
    here = plugin_number()
    if here != number:
        msg = (
            f"pickled where {_plugin.PLUGIN_NAME} was plugin number {number}, here it "
            f"is {here}: import the plugins of both processes in the same order"
        )
        raise PluginError(msg)
    found = kind.__new__(kind)
    found.__setstate__(state)
    return found


def _reduce_model(model: mujoco.MjModel) -> tuple[Any, ...]:
    """Returns how to pickle a model."""
    return _reduce(model, model)


def _reduce_data(data: mujoco.MjData) -> tuple[Any, ...]:
    """Returns how to pickle data, which hold their model."""
    return _reduce(data, data.model)


def _reduce(thing: Any, model: mujoco.MjModel) -> tuple[Any, ...]:
    """Returns MuJoCo's own way, or `restore` if the model carries the plugin."""
    if not _carries_plugin(model):
        made_by = copyreg.__newobj__  # type: ignore[attr-defined]
        return (made_by, (type(thing),), thing.__getstate__())
    number, version = plugin_number(), mujoco.mj_versionString()
    return (restore, (type(thing), thing.__getstate__(), number, version))


def _carries_plugin(model: mujoco.MjModel) -> bool:
    """Returns whether a model has an instance of our plugin."""
    if model.nplugin == 0 or not _plugin.is_registered():
        return False
    return bool(np.any(model.plugin == plugin_number()))
