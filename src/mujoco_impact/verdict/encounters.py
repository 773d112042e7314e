"""Which geoms of a model can meet which, and from how far they are seen."""

from __future__ import annotations

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact.pulses import plugin_instances
from mujoco_impact.trajectory import Array

Flags = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.intp]

EXCLUDE_SHIFT = 16
"""`exclude_signature` holds two bodies: (smaller << 16) + larger."""


def owned_numbers(model: mujoco.MjModel) -> Numbers:
    """Returns the ids of the geoms that instances of the plugin own, shape (n,)."""
    owned: set[int] = set()
    for instance in plugin_instances(model):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_PLUGIN, instance)
        found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TUPLE, name or "")
        if found < 0:
            return np.arange(model.ngeom)
        first = int(model.tuple_adr[found])
        elements = slice(first, first + int(model.tuple_size[found]))
        # what has a negative number is not owned: the tuple only says its material
        members = model.tuple_objid[elements][model.tuple_objprm[elements] >= 0]
        owned.update(members.tolist())
    return np.array(sorted(owned), dtype=np.intp)


def meetings(model: mujoco.MjModel, geoms: Numbers) -> Flags:
    """Returns whether each of n geoms can be in a contact with each geom of the model.

    Args:
        model: The model.
        geoms: Ids of the n geoms.

    Returns:
        Flags, shape (n, ngeom): MuJoCo's filters of bodies and of contact types, and
        the explicit pairs, which pass all filters.
    """
    kind, affinity = model.geom_contype, model.geom_conaffinity
    able = (kind[geoms][:, None] & affinity) | (affinity[geoms][:, None] & kind)
    body, weld = model.geom_bodyid, model.body_weldid[model.geom_bodyid]
    result: Flags = (able != 0) & (weld[geoms][:, None] != weld)
    if not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
        # a body and its parent, unless the parent is the world
        above = model.body_weldid[model.body_parentid[weld]]
        inside = (weld[geoms] != 0)[:, None] & (weld != 0)
        related = (above[geoms][:, None] == weld) | (weld[geoms][:, None] == above)
        result &= ~(inside & related)
    if model.nexclude:
        low = np.minimum(body[geoms][:, None], body)
        high = np.maximum(body[geoms][:, None], body)
        result &= ~np.isin((low << EXCLUDE_SHIFT) + high, model.exclude_signature)
    row = {int(geom): index for index, geom in enumerate(geoms)}
    for first, second in zip(model.pair_geom1, model.pair_geom2, strict=True):
        for one, other in ((first, second), (second, first)):
            if int(one) in row:
                result[row[int(one)], other] = True
    return result


def sights(model: mujoco.MjModel, geoms: Numbers) -> Array:
    """Returns the distance from which each contact is seen [m], shape (n, ngeom).

    Margins and gaps of two geoms add; an explicit pair has its own.
    """
    own = model.geom_margin + model.geom_gap
    result: Array = own[geoms][:, None] + own
    row = {int(geom): index for index, geom in enumerate(geoms)}
    for pair in range(model.npair):
        first, second = int(model.pair_geom1[pair]), int(model.pair_geom2[pair])
        for one, other in ((first, second), (second, first)):
            if one in row:
                seen = model.pair_margin[pair] + model.pair_gap[pair]
                result[row[one], other] = seen
    return result


def half_widths(model: mujoco.MjModel) -> Array:
    """Returns half of the smallest width of each geom [m]; inf for planes, fields."""
    widths: Array = model.geom_aabb[:, 3:].min(axis=1)
    unbounded = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)
    widths[np.isin(model.geom_type, unbounded)] = np.inf
    return widths
