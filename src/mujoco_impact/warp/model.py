"""MuJoCo Warp's model of a scene whose impacts are ours."""

from __future__ import annotations

import copy
import functools
from typing import Any

import mujoco
import mujoco_warp
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.pulses import plugin_instances
from mujoco_impact.warp.scene import fingerprint, read_scene

OURS = "impacts_are_ours"
"""Attribute that tells such a model of MuJoCo Warp: the fingerprint of MuJoCo's."""

_step = mujoco_warp.step
_put_model = getattr(mujoco_warp.put_model, "__wrapped__", mujoco_warp.put_model)


def put_model(model: mujoco.MjModel, **options: Any) -> Any:
    """Returns MuJoCo Warp's model of a scene with the plugin.

    Contacts of the owned geoms stay out of its solver through their negative margins,
    as in MuJoCo. Step it with `mujoco_impact.warp.step`; `mujoco_warp.step` refuses it,
    for it would leave the impacts out. The plugin's sensor reads NaN.

    Args:
        model: A compiled model of `mujoco_impact.attach`; not changed.
        **options: Those of `mujoco_warp.put_model`.

    Returns:
        A `mujoco_warp.Model`.

    Raises:
        SceneError: If the model has no instance of the plugin, or something that is
            not supported (docs/gpu.md).
    """
    read_scene(model)
    put = _put_model(_without_plugin(model), **options)
    setattr(put, OURS, fingerprint(model))
    return put


def _without_plugin(model: mujoco.MjModel) -> mujoco.MjModel:
    """Returns a copy of a model in which MuJoCo Warp finds no element of our plugin."""
    plain = copy.copy(model)
    ours = plugin_instances(model)
    for number in range(model.nsensor):
        if model.sensor_plugin[number] in ours:
            # its numbers keep their place
            plain.sensor_type[number] = mujoco.mjtSensor.mjSENS_USER
            plain.sensor_plugin[number] = -1
    plain.body_plugin[np.isin(model.body_plugin, ours)] = -1
    # MuJoCo Warp counts all instances and lists those of geoms: each gets a geom, whose
    # shape does not ask for one, and attributes that are numbers
    free = np.flatnonzero(model.geom_plugin == -1)
    for instance, geom in zip(ours, free, strict=False):
        begin, end = _attributes(model, instance)
        plain.geom_plugin[geom] = instance
        plain.plugin_attr[begin:end] = 0
    return plain


def _attributes(model: mujoco.MjModel, instance: int) -> tuple[int, int]:
    """Returns where the attributes of an instance begin and end."""
    ends = [*model.plugin_attradr[1:], len(model.plugin_attr)]
    return int(model.plugin_attradr[instance]), int(ends[instance])


@functools.wraps(_step)
def _guarded_step(m: Any, d: Any) -> None:
    """Steps a model, but none whose impacts are ours."""
    if getattr(m, OURS, False):
        msg = (
            "mujoco_warp.step would leave the impacts out of a model of "
            "mujoco_impact.warp.put_model: use mujoco_impact.warp.step(m, d, impacts)"
        )
        raise SceneError(msg)
    _step(m, d)


mujoco_warp.step = _guarded_step
