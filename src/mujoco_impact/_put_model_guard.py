"""A clear refusal where MuJoCo Warp and MJX would drop the plugin.

Neither runs engine plugins. What they say of a model that has one depends on the
element that carries the instance, and names no way out; so their `put_model` is
wrapped as soon as they are imported.
"""

from __future__ import annotations

import functools
from types import ModuleType
from typing import Any

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.pulses import plugin_instances

GUARDED = ("mujoco_warp", "mujoco.mjx")
"""Modules whose `put_model` takes MuJoCo's models to another engine."""

_WAYS_OUT = {
    "mujoco_warp": "mujoco_impact.warp.put_model and put_impacts compute the impacts "
    "there; without them, mujoco_impact.detach gives the scene MuJoCo's own contacts",
    "mujoco.mjx": "mujoco_impact.warp computes them beside MuJoCo Warp; for MJX, "
    "mujoco_impact.detach gives the scene MuJoCo's own contacts",
}


def guard(module: ModuleType) -> None:
    """Makes `put_model` of the module refuse models whose impacts are ours."""
    put_model = module.put_model
    if getattr(put_model, "refuses_impacts", False):
        return

    @functools.wraps(put_model)
    def guarded(*args: Any, **options: Any) -> Any:
        for argument in (*args, *options.values()):
            if isinstance(argument, mujoco.MjModel):
                refuse_impacts(argument, module.__name__)
        return put_model(*args, **options)

    guarded.refuses_impacts = True  # type: ignore[attr-defined]
    module.put_model = guarded  # type: ignore[attr-defined]


def refuse_impacts(model: mujoco.MjModel, engine: str) -> None:
    """Raises SceneError if impacts of the model are the plugin's.

    Args:
        model: The model that `engine`, one of `GUARDED`, is given.
        engine: Name of the module.
    """
    if plugin_instances(model):
        names = ", ".join(
            repr(_name(model, mujoco.mjtObj.mjOBJ_PLUGIN, instance))
            for instance in plugin_instances(model)
        )
        msg = (
            f"{engine} runs no engine plugin: impacts of the instance {names} would be "
            f"left out. {_WAYS_OUT[engine]}"
        )
        raise SceneError(msg)
    for number in range(model.ntuple):
        if _is_left_over(model, number):
            name = _name(model, mujoco.mjtObj.mjOBJ_TUPLE, number)
            msg = (
                f"the geoms of the tuple {name!r} have the negative margins "
                "that hand contacts to mujoco_impact, but the model has no "
                "instance of it: the compiler drops an instance whose sensor is gone. "
                "Keep the sensor that attach adds, or give the geoms margin 0 and gap 0"
            )
            raise SceneError(msg)


def _is_left_over(model: mujoco.MjModel, number: int) -> bool:
    """Returns whether a tuple is one of owned geoms."""
    begin, size = int(model.tuple_adr[number]), int(model.tuple_size[number])
    part = slice(begin, begin + size)
    if np.any(model.tuple_objtype[part] != mujoco.mjtObj.mjOBJ_GEOM):
        return False
    # what has a negative number only says its material
    owned = model.tuple_objid[part][model.tuple_objprm[part] >= 0]
    return owned.size > 0 and bool(np.all(model.geom_margin[owned] < 0))


def _name(model: mujoco.MjModel, kind: mujoco.mjtObj, number: int) -> str:
    """Returns the name of an element."""
    return mujoco.mj_id2name(model, kind, number) or ""
