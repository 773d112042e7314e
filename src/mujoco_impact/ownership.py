"""Which geoms are ours, and the margins that make their contacts ours.

MuJoCo keeps a contact out of its solver while `margin < dist <= margin + gap`, and
adds the margins and the gaps of the two geoms. An owned geom with the margin -M and
the gap M + g therefore hands its contacts to the plugin from g before touching
down to M of overlap (2 g and 2 M between two owned geoms).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.instances import our_instances
from mujoco_impact.text import closest

GAP_SIZE_FRACTION = 0.5
"""Smallest default gap, as a fraction of the smallest owned geom's half-width."""


SPEED_ROOM = 1.25
"""Gap for a closing speed, over the way of one step: bodies gain speed meanwhile."""


def select_geoms(spec: mujoco.MjSpec, names: Iterable[str] | None) -> tuple[str, ...]:
    """Returns the names of the geoms to own, in the order of the model or of `names`.

    Args:
        spec: The scene; unnamed geoms that are taken get a name.
        names: Names of geoms, or None for every geom of a moving body that can
            collide.

    Raises:
        SceneError: If a name is unknown, given twice or of a geom that cannot
            collide, or if nothing is left to own.
    """
    paired = _names_in_pairs(spec)
    if names is None:
        chosen = [
            geom
            for geom in spec.geoms
            if _collides(geom, paired) and _is_moving(geom.parent)
        ]
        if not chosen:
            msg = "no body of the scene that can move has a geom that can collide"
            raise SceneError(msg)
        _name_unnamed(spec, chosen)
        return tuple(geom.name for geom in chosen)
    try:
        wanted = (names,) if isinstance(names, str) else tuple(names)
    except TypeError as error:
        raise SceneError(f"geoms = {names!r}: must be names of geoms") from error
    _check_names(spec, wanted, paired)
    return wanted


def owned_geoms(spec: mujoco.MjSpec) -> dict[str, tuple[str, ...] | None]:
    """Returns the geoms of each plugin instance of a scene.

    Returns:
        Names of the owned geoms by instance name; None for an instance without a
        tuple, which owns every geom.
    """
    # what has a negative number is not owned: the tuple only says its material
    tuples = {
        element.name: tuple(
            geom
            for geom, number in zip(element.objname, element.objprm, strict=True)
            if number >= 0
        )
        for element in spec.tuples
    }
    return {instance: tuples.get(instance) for instance in our_instances(spec)}


def set_margins(
    spec: mujoco.MjSpec, owned: Sequence[str], *, gap: float, depth: float
) -> None:
    """Sets margin and gap of the owned geoms and of the pairs that name them.

    A partner with a margin of its own would shift the sum and could hand the contact
    back to MuJoCo before the geoms touch, so the largest of those margins is taken
    off. An explicit pair replaces the margins of its geoms and gets their sum.

    Args:
        spec: The scene, changed in place.
        owned: Names of the owned geoms.
        gap: How early a contact of an owned geom is seen, g [m].
        depth: Overlap at which MuJoCo's own contact takes over, M [m].
    """
    ours = set(owned)
    partner_margin = max(
        (geom.margin for geom in spec.geoms if geom.name not in ours), default=0.0
    )
    margin = depth + max(partner_margin, 0.0)
    for geom in spec.geoms:
        if geom.name in ours:
            geom.margin = -margin
            geom.gap = round(margin + gap, 12)
    for pair in spec.pairs:
        count = (pair.geomname1 in ours) + (pair.geomname2 in ours)
        if count:
            pair.margin = -count * depth
            pair.gap = round(count * (depth + gap), 12)


def default_gap(
    model: mujoco.MjModel, owned: Sequence[str], *, speed: float | None = None
) -> float:
    """Returns how early a contact of an owned geom should be seen [m].

    The plugin must see an impact at least one step before it happens, so the gap is
    what a body that fell through the scene travels in one step; never less than half
    of the half-width of the smallest owned geom, for scenes without gravity, and
    enough for a closing speed [m/s] that is expected.
    """
    size = smallest_size(model, owned)
    timestep = float(model.opt.timestep)
    travel = max(GAP_SIZE_FRACTION * size, fall_speed(model) * timestep)
    usual = round_up(travel)
    return usual if speed is None else max(usual, gap_for_speed(speed, timestep))


def gap_for_speed(speed: float, timestep: float) -> float:
    """Returns the gap [m] that announces contacts closing at a speed [m/s]."""
    return round_up(SPEED_ROOM * speed * timestep)


def fall_speed(model: mujoco.MjModel) -> float:
    """Returns the speed of a body that gravity pulled through the scene [m/s]."""
    gravity = float(np.linalg.norm(model.opt.gravity))
    return math.sqrt(2.0 * gravity * model.stat.extent)


def smallest_size(model: mujoco.MjModel, owned: Sequence[str]) -> float:
    """Returns the smallest half-width of the owned geoms [m].

    Planes and height fields have no width; if only those are owned, the geoms of
    the bodies that can move are measured instead.
    """
    widths = [_half_width(model, model.geom(name).id) for name in owned]
    finite = [width for width in widths if width is not None]
    if not finite:
        moving = np.flatnonzero(model.body_weldid[model.geom_bodyid] != 0)
        widths = [_half_width(model, int(geom)) for geom in moving]
        finite = [width for width in widths if width is not None]
    if not finite:
        msg = f"none of the owned geoms {', '.join(owned)} can meet a moving geom"
        raise SceneError(msg)
    return min(finite)


def round_up(length: float) -> float:
    """Returns a length rounded up to three digits: MJCF text keeps only seven."""
    exponent = 2 - math.floor(math.log10(length))
    scale = 10.0**exponent
    return round(math.ceil(length * scale * (1 - 1e-12)) / scale, max(exponent, 0))


def _half_width(model: mujoco.MjModel, geom: int) -> float | None:
    """Returns half of the smallest width of a geom [m], None if it has no width."""
    unbounded = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)
    if model.geom_type[geom] in unbounded:
        return None
    return float(np.min(model.geom_aabb[geom, 3:]))


def _check_names(
    spec: mujoco.MjSpec, wanted: Sequence[str], paired: frozenset[str]
) -> None:
    """Raises SceneError if the wanted geoms cannot be owned."""
    by_name = {geom.name: geom for geom in spec.geoms if geom.name}
    if not wanted:
        msg = f"geoms must name at least one geom{closest('', by_name)}"
        raise SceneError(msg)
    for position, name in enumerate(wanted):
        if not isinstance(name, str) or name not in by_name:
            msg = f"there is no geom {name!r}{closest(str(name), by_name)}"
            raise SceneError(msg)
        if name in wanted[:position]:
            msg = f"geom {name!r} is given twice"
            raise SceneError(msg)
        if not _collides(by_name[name], paired):
            msg = f"geom {name!r} cannot collide: its contype and conaffinity are 0"
            raise SceneError(msg)


def _names_in_pairs(spec: mujoco.MjSpec) -> frozenset[str]:
    """Returns the names of the geoms of all explicit contact pairs."""
    return frozenset(
        name for pair in spec.pairs for name in (pair.geomname1, pair.geomname2)
    )


def _collides(geom: mujoco.MjsGeom, paired: frozenset[str]) -> bool:
    """Returns whether a geom can be in a contact at all."""
    return bool(geom.contype or geom.conaffinity) or geom.name in paired


def _is_moving(body: mujoco.MjsBody | None) -> bool:
    """Returns whether a body has a joint, or hangs on one that has."""
    while body is not None:
        if body.joints:
            return True
        body = body.parent
    return False


def _name_unnamed(spec: mujoco.MjSpec, geoms: Iterable[mujoco.MjsGeom]) -> None:
    """Gives each unnamed geom a name that is not in use."""
    taken = {geom.name for geom in spec.geoms}
    for geom in geoms:
        if geom.name:
            continue
        stem = f"{geom.parent.name or 'body'}_geom"
        number = 0
        while f"{stem}{number}" in taken:
            number += 1
        geom.name = f"{stem}{number}"
        taken.add(geom.name)
