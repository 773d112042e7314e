"""Refusing scenes in which the plugin could not do its work, with the reason."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from mujoco_impact.errors import SceneError
from mujoco_impact.ownership import owned_geoms


def check_options(spec: mujoco.MjSpec) -> None:
    """Raises SceneError if global options switch our contacts off or to MuJoCo."""
    disabled = mujoco.mjtDisableBit
    flags = spec.option.disableflags
    for bit, flag in (
        (disabled.mjDSBL_CONTACT, "contact"),
        (disabled.mjDSBL_CONSTRAINT, "constraint"),
    ):
        if flags & bit:
            msg = f'the scene has <flag {flag}="disable"/>: MuJoCo finds no contacts'
            raise SceneError(msg)
    if flags & disabled.mjDSBL_SPRING and flags & disabled.mjDSBL_DAMPER:
        msg = (
            'the scene has <flag spring="disable" damper="disable"/>: MuJoCo then '
            "calls no passive plugin, and the owned geoms would pass through each other"
        )
        raise SceneError(msg)
    if spec.option.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE:
        msg = (
            'the scene has <flag override="enable"/>: it replaces the margins that '
            "keep our contacts out of MuJoCo's solver"
        )
        raise SceneError(msg)


def check_name(spec: mujoco.MjSpec, name: str) -> None:
    """Raises SceneError if the name is no text, empty or in use."""
    if not isinstance(name, str) or not name:
        msg = f"name = {name!r}: must be text, by which the plugin finds its geoms"
        raise SceneError(msg)
    for kind, elements in (
        ("plugin instance", spec.plugins),
        ("tuple", spec.tuples),
        ("sensor", spec.sensors),
    ):
        if any(element.name == name for element in elements):
            msg = f"the scene already has a {kind} {name!r}: give another name="
            raise SceneError(msg)


def check_owned(spec: mujoco.MjSpec, owned: Sequence[str]) -> None:
    """Raises SceneError if geoms cannot be given to a further plugin instance."""
    for instance, names in owned_geoms(spec).items():
        shared = owned if names is None else sorted(set(owned) & set(names))
        if shared:
            msg = (
                f"the plugin instance {instance!r} of the scene already owns "
                f"{', '.join(shared)}"
            )
            raise SceneError(msg)
    geoms = [geom for geom in spec.geoms if geom.name in set(owned)]
    for geom in geoms:
        if geom.adhesion:
            msg = (
                f"geom {geom.name!r} has adhesion {geom.adhesion}: MuJoCo then "
                "solves its contacts itself; set it to 0 or own other geoms"
            )
            raise SceneError(msg)
    _check_pairs(spec, owned)
    _check_adhesion_actuators(spec, owned)
    _check_flexes(spec, geoms)


def _check_pairs(spec: mujoco.MjSpec, owned: Sequence[str]) -> None:
    """Raises SceneError if an owned geom is in a pair with adhesion."""
    for pair in spec.pairs:
        if pair.adhesion and {pair.geomname1, pair.geomname2} & set(owned):
            msg = (
                f"the pair of {pair.geomname1!r} and {pair.geomname2!r} has adhesion "
                f"{pair.adhesion}: MuJoCo then solves its contacts itself"
            )
            raise SceneError(msg)


def _check_adhesion_actuators(spec: mujoco.MjSpec, owned: Sequence[str]) -> None:
    """Raises SceneError if an adhesion actuator acts on contacts of owned geoms.

    It pulls on all contacts in MuJoCo's list, ours from the gap on: 10 N across 2.5 mm
    of air. As with adhesion of geoms there is no impact law for what sticks.
    """
    ours = set(owned)
    for actuator in spec.actuators:
        if actuator.trntype != mujoco.mjtTrn.mjTRN_BODY:
            continue
        for geom in spec.geoms:
            if geom.parent.name == actuator.target and _may_meet(spec, geom, ours):
                msg = (
                    f"the adhesion actuator {actuator.name!r} of the body "
                    f"{actuator.target!r} would act across the gap of owned geoms: own "
                    f"neither geoms of that body nor what it can touch (geoms=), or "
                    "take the actuator out"
                )
                raise SceneError(msg)


def _may_meet(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, ours: set[str]) -> bool:
    """Returns whether a geom is one of ours, or can be in contact with one."""
    if geom.name in ours:
        return True
    paired = {
        name
        for pair in spec.pairs
        if geom.name in (pair.geomname1, pair.geomname2)
        for name in (pair.geomname1, pair.geomname2)
    }
    return bool(paired & ours) or any(
        geom.contype & other.conaffinity or other.contype & geom.conaffinity
        for other in spec.geoms
        if other.name in ours
    )


def _check_flexes(spec: mujoco.MjSpec, geoms: Sequence[mujoco.MjsGeom]) -> None:
    """Raises SceneError if an owned geom can touch a flex, which has no geoms."""
    for flex in spec.flexes:
        for geom in geoms:
            if geom.contype & flex.conaffinity or flex.contype & geom.conaffinity:
                msg = (
                    f"geom {geom.name!r} can touch the flex {flex.name!r}, which is "
                    "not supported: separate them by contype and conaffinity, or own "
                    "other geoms"
                )
                raise SceneError(msg)
