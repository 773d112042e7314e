"""Our contacts for PyMJCF models. Importing this module needs dm_control."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import mujoco

from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.assignment import Materials, Pairs
from mujoco_impact.errors import SceneError
from mujoco_impact.extras import require
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.scene import attach
from mujoco_impact.settings import Setting
from mujoco_impact.specifications import one_line

mjcf: Any = require("dm_control.mjcf")


def attach_mjcf(
    root: Any,
    *,
    geoms: Iterable[Any] | None = None,
    name: str = "impact",
    gap: float | None = None,
    depth: float | None = None,
    speed: float | None = None,
    materials: Materials | None = None,
    assign: Mapping[str, str] | None = None,
    pairs: Pairs | None = None,
    **settings: Setting,
) -> Any:
    """Gives the impacts of a PyMJCF model to the plugin, in place.

    Does what `mujoco_impact.attach` does to an `MjSpec`. The model may be attached to
    others afterwards; what depends on the scene (the default gap on timestep and
    gravity) is taken from the model as it is now.

    Args:
        root: The model (`dm_control.mjcf.RootElement`).
        geoms: Geoms to own, as elements or full identifiers; by default every geom
            that can collide of every body that can move.
        name: Name of the plugin instance, the tuple and the sensor.
        gap: See `mujoco_impact.attach`.
        depth: See `mujoco_impact.attach`.
        speed: See `mujoco_impact.attach`.
        materials: See `mujoco_impact.attach`.
        assign: See `mujoco_impact.attach`; geoms by full identifiers.
        pairs: See `mujoco_impact.attach`; geoms by full identifiers.
        **settings: Settings of the impact law.

    Returns:
        The PyMJCF element of the sensor, for `physics.bind`.

    Raises:
        SceneError: If the model cannot be compiled, or cannot take the plugin.
        ConfigError: If a setting, the gap or the depth is not valid.
    """
    _name_geoms(root)
    wanted = None if geoms is None else [_identifier(geom) for geom in geoms]
    spec = attach(
        _specification(root),
        geoms=wanted,
        name=name,
        gap=gap,
        depth=depth,
        speed=speed,
        materials=materials,
        assign=assign,
        pairs=pairs,
        **settings,
    )
    owned = owned_geoms(spec)[name] or ()
    _take_margins(root, spec, set(owned))
    instance = next(one for one in spec.plugins if one.name == name)
    _add_instance(root, name, dict(instance.config))
    elements = next(element for element in spec.tuples if element.name == name)
    members = root.custom.add("tuple", name=name)
    for geom, number in zip(elements.objname, elements.objprm, strict=True):
        element = root.find("geom", geom)
        members.add("element", objtype="geom", objname=element, prm=number)
    return root.sensor.add("plugin", name=name, plugin=PLUGIN_NAME, instance=name)


def _identifier(geom: Any) -> str:
    """Returns the full identifier of a geom given as an element or by that."""
    return geom if isinstance(geom, str) else str(geom.full_identifier)


def _name_geoms(root: Any) -> None:
    """Gives each unnamed geom a name that is not in use, as the tuple needs one."""
    geoms = root.find_all("geom")
    taken = {geom.full_identifier for geom in geoms if geom.name}
    for number, geom in enumerate(geom for geom in geoms if not geom.name):
        stem = f"geom{number}"
        while _scoped(geom, stem) in taken:
            stem += "_"
        geom.name = stem
        taken.add(geom.full_identifier)


def _scoped(geom: Any, name: str) -> str:
    """Returns the full identifier that a geom would have under a name."""
    prefix = geom.root.full_identifier
    return f"{prefix}{name}" if prefix else name


def _specification(root: Any) -> mujoco.MjSpec:
    """Returns the model as MuJoCo reads it."""
    try:
        return mujoco.MjSpec.from_string(
            root.to_xml_string(), assets=dict(root.get_assets())
        )
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot read the PyMJCF model: {one_line(error)}"
        raise SceneError(msg) from error


def _take_margins(root: Any, spec: mujoco.MjSpec, owned: set[str]) -> None:
    """Copies the margins that `attach` found to the PyMJCF elements."""
    for geom in spec.geoms:
        if geom.name in owned:
            element = root.find("geom", geom.name)
            element.margin, element.gap = geom.margin, geom.gap
    pairs = {(pair.geomname1, pair.geomname2): pair for pair in spec.pairs}
    for element in root.find_all("contact"):
        if element.tag != "pair":
            continue
        names = (element.geom1.full_identifier, element.geom2.full_identifier)
        if owned & set(names):
            element.margin, element.gap = pairs[names].margin, pairs[names].gap


def _add_instance(root: Any, name: str, config: dict[str, str]) -> None:
    """Adds the plugin instance with its settings."""
    plugin = root.extension.add("plugin", plugin=PLUGIN_NAME)
    instance = plugin.add("instance", name=name)
    for key, value in config.items():
        instance.add("config", key=key, value=value)
