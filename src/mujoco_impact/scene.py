"""Giving the impacts of a scene to the plugin, and taking them back."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import mujoco

from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.assignment import Materials, Pairs, assign_materials
from mujoco_impact.blind_sensors import warn_of_blind_sensors
from mujoco_impact.depth import ROUNDING, check_depth, default_depth
from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.instances import remove_instances
from mujoco_impact.ownership import (
    default_gap,
    owned_geoms,
    select_geoms,
    set_margins,
)
from mujoco_impact.scene_checks import check_name, check_options, check_owned
from mujoco_impact.settings import Setting, attributes
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec, copy_spec
from mujoco_impact.text import as_number


def attach(
    source: Source,
    *,
    geoms: Iterable[str] | None = None,
    name: str = "impact",
    gap: float | None = None,
    depth: float | None = None,
    speed: float | None = None,
    materials: Materials | None = None,
    assign: Mapping[str, str] | None = None,
    pairs: Pairs | None = None,
    **settings: Setting,
) -> mujoco.MjSpec:
    """Returns a copy of a scene whose impacts are computed by the plugin.

    Adds a plugin instance with its settings, a `<tuple>` of the owned geoms and a
    sensor (all three called `name`), and gives the owned geoms a negative margin, so
    that MuJoCo detects their contacts and leaves them out of its solver. Impacts
    have the friction that MuJoCo finds for the contact, none if `condim` is 1 or
    `friction="none"` is set. Warns (`ImpactWarning`) of
    MuJoCo's sensors that do not see these impacts.

    Args:
        source: Path of a model file, XML text, or a specification (not changed).
        geoms: Names of the geoms to own; by default every geom that can collide of
            every body that can move. The order matters to the setting `alpha` and
            to the sensor.
        name: Name of the plugin instance, the tuple and the sensor.
        gap: How early a contact of an owned geom is seen [m]. It must exceed closing
            speed times timestep. Default: what a body that fell through the
            whole scene travels in one step, and not less than a quarter of the width
            of the smallest owned geom. Doubles between two owned geoms.
        speed: Closing speed of the fastest impact expected [m/s], instead of `gap`: the
            gap is then what that makes in a step, and a quarter more, if the default
            is smaller.
        depth: Overlap at which MuJoCo's own contact takes over where no pulse presses
            [m]: a resting geom sinks that much deeper than without the plugin.
            Default: 1e-7 m; 1e-6 m if bodies overlap by up to 2e-6 m in the initial
            pose, as of rounding. If `duration` is longer than a Hertz contact, what
            bodies overlap during a pulse, but 1 to 50 % of half of the width of the
            smallest owned geom. Must be less than that half. Doubles between two owned
            geoms.
        materials: Materials by name, `Material` or a dict of its attributes, beside
            those of `MATERIALS`.
        assign: Name of the material by name of the geom, or by a pattern such as
            "ball*". Geoms need not be owned. A geom of no material is as the settings
            have it.
        pairs: What counts between two materials or geoms, by both names in any order,
            `MaterialPair` or a dict of its attributes, such as
            {("cue", "cushion"): {"restitution": 0.85}}.
        **settings: Settings of the impact law, see `mujoco_impact.settings.SETTINGS`;
            for example `restitution=0.9`, `young=210e9`, `duration="paper"`.

    Returns:
        A specification that compiles; `spec.compile()` gives the model.

    Raises:
        SceneError: If the scene cannot be read, or cannot take the plugin.
        ConfigError: If a setting, a material, the gap or the depth is not valid.
        PluginError: If the plugin library cannot be loaded.
    """
    config = attributes(settings)
    for label, number, unit in (
        ("gap", gap, "length > 0 [m]"),
        ("depth", depth, "length > 0 [m]"),
        ("speed", speed, "speed > 0 [m/s]"),
    ):
        _check_positive(label, number, unit)
    if gap is not None and speed is not None:
        msg = f"gap = {gap} and speed = {speed}: give one of them, speed sets the gap"
        raise ConfigError(msg)
    spec = read_spec(source)
    check_options(spec)
    check_name(spec, name)
    owned = select_geoms(spec, geoms)
    check_owned(spec, owned)
    materials_of = assign_materials(spec, materials, assign, pairs)
    config |= materials_of.config
    _add_instance(spec, name, owned, config, materials_of.numbers)
    # lengths of the scene are known once it is compiled, with any valid margin
    set_margins(spec, owned, gap=ROUNDING, depth=ROUNDING)
    model = _compile_with_plugin(spec, config)
    if depth is not None:
        check_depth(model, owned, depth)
    set_margins(
        spec,
        owned,
        gap=default_gap(model, owned, speed=speed) if gap is None else gap,
        depth=default_depth(model, owned, config) if depth is None else depth,
    )
    warn_of_blind_sensors(model, owned)
    return spec


def detach(source: Source) -> mujoco.MjSpec:
    """Returns a copy of a scene without the plugin: MuJoCo's own contacts.

    Every instance of the plugin goes, with its tuple and its sensors, and the geoms
    and pairs it owned get margin 0 and gap 0, MuJoCo's defaults.

    Args:
        source: Path of a model file, XML text, or a specification (not changed).

    Raises:
        SceneError: If the scene cannot be read.
    """
    spec = read_spec(source)
    owned = owned_geoms(spec)
    remove_instances(spec)
    everything = {geom.name for geom in spec.geoms}
    _clear_margins(
        spec,
        {
            geom
            for names in owned.values()
            for geom in (everything if names is None else names)
        },
    )
    return spec


def _add_instance(
    spec: mujoco.MjSpec,
    name: str,
    owned: Sequence[str],
    config: Mapping[str, str],
    materials: Mapping[str, int],
) -> None:
    """Adds the plugin instance, the tuple of its geoms and its sensor.

    The tuple also says of which material a geom is. Those that are not owned come last,
    with a negative number.
    """
    spec.activate_plugin(PLUGIN_NAME)
    instance = spec.add_plugin(name=name, plugin_name=PLUGIN_NAME, active=True)
    instance.config = dict(config)
    others = sorted(set(materials) - set(owned))
    spec.add_tuple(
        name=name,
        objtype=[mujoco.mjtObj.mjOBJ_GEOM] * (len(owned) + len(others)),
        objname=[*owned, *others],
        objprm=[
            *(float(materials.get(geom, 0)) for geom in owned),
            *(-float(materials[geom]) for geom in others),
        ],
    )
    # the sensor also keeps the instance alive when models are attached to each other
    sensor = spec.add_sensor(name=name, type=mujoco.mjtSensor.mjSENS_PLUGIN)
    sensor.plugin.active = True
    sensor.plugin.name = name
    sensor.plugin.plugin_name = PLUGIN_NAME


def _compile_with_plugin(
    spec: mujoco.MjSpec, config: Mapping[str, str]
) -> mujoco.MjModel:
    """Compiles a copy of the scene; blames the settings if the plugin refuses them."""
    try:
        return compile_spec(copy_spec(spec))
    except SceneError as error:
        # MuJoCo quotes the warning of the plugin, twice
        _, plugin, reason = str(error).partition(f"{PLUGIN_NAME}: ")
        if not plugin:
            raise
        reason = reason.partition(PLUGIN_NAME)[0].strip()
        shown = ", ".join(f"{key}={value}" for key, value in config.items())
        msg = f"the plugin refuses {shown or 'its default settings'}: {reason}"
        raise ConfigError(msg) from error


def _check_positive(label: str, number: float | None, allowed: str) -> None:
    """Raises ConfigError if a number is not positive and finite."""
    if number is None:
        return
    if not 0 < (as_number(number) or 0) < math.inf:
        msg = f"{label} = {number!r}: must be a {allowed}"
        raise ConfigError(msg)


def _clear_margins(spec: mujoco.MjSpec, names: set[str]) -> None:
    """Gives the named geoms and their pairs MuJoCo's default margin and gap, 0."""
    for geom in spec.geoms:
        if geom.name in names:
            geom.margin = geom.gap = 0.0
    for pair in spec.pairs:
        if {pair.geomname1, pair.geomname2} & names:
            pair.margin = pair.gap = 0.0
