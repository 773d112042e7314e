"""Plugin instances of a specification: which are ours, and how to be rid of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import mujoco

from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.errors import SceneError
from mujoco_impact.pulses import plugin_instances
from mujoco_impact.specifications import compile_spec, copy_spec

_removed: list[mujoco.MjsPlugin] = []
"""Instances taken out that a body named: MuJoCo leaves the body pointing to them, and
follows the pointer. They are some hundred bytes each."""


def our_instances(spec: mujoco.MjSpec) -> list[str]:
    """Returns the names of the instances of our plugin."""
    if not spec.plugins:
        return []
    references = [reference for _, reference in _references(spec)]
    ours = {one.name for one in references if one.plugin_name == PLUGIN_NAME}
    told = {one.name for one in references if one.plugin_name}
    named = {one.name for one in references}
    if named - told:
        # the instance knows, but in a copy its text may be that of a source that is
        # gone; one that no element names is never a copy
        ours |= set(_compiled_instances(spec))
    names = [
        instance.name
        for instance in spec.plugins
        if instance.name in ours
        or (instance.name not in named and instance.plugin_name == PLUGIN_NAME)
    ]
    return list(dict.fromkeys(names))


def remove_instances(spec: mujoco.MjSpec) -> None:
    """Takes our instances out of a specification, with their sensors and tuples."""
    names = our_instances(spec)
    instances = {one.name: one for one in spec.plugins if one.name in names}
    for element, reference in list(_references(spec)):
        if reference.name not in instances:
            continue
        if isinstance(element, mujoco.MjsSensor):
            spec.delete(element)
        else:
            _removed.append(instances[reference.name])
            reference.active = False
            reference.name = reference.plugin_name = ""
    # the last sensor may have taken its instance with it
    for element in (*spec.tuples, *spec.plugins):
        if element.name in instances:
            spec.delete(element)


def check_named(spec: mujoco.MjSpec) -> None:
    """Raises SceneError if an element has an instance of our plugin to itself.

    Geoms are owned by the name of an instance, and MuJoCo does not tell instances
    without a name apart.
    """
    for element, reference in _references(spec) if spec.plugins else ():
        if not reference.name and reference.plugin_name == PLUGIN_NAME:
            kind = type(element).__name__.removeprefix("Mjs").lower()
            msg = (
                f"the {kind} {element.name!r} uses the plugin {PLUGIN_NAME} without an "
                'instance: name one, <instance name="impact"/> in <extension>'
            )
            raise SceneError(msg)


def _references(spec: mujoco.MjSpec) -> Iterator[tuple[Any, mujoco.MjsPlugin]]:
    """Yields the elements that use a plugin, each with its reference to an instance."""
    for elements in (
        spec.bodies,
        spec.geoms,
        spec.meshes,
        spec.actuators,
        spec.sensors,
    ):
        for element in elements:
            if element.plugin.active:
                yield element, element.plugin


def _compiled_instances(spec: mujoco.MjSpec) -> list[str]:
    """Returns the names of our instances as the compiler resolves them."""
    model = compile_spec(copy_spec(spec))
    kind = mujoco.mjtObj.mjOBJ_PLUGIN
    return [
        mujoco.mj_id2name(model, kind, number) or ""
        for number in plugin_instances(model)
    ]
