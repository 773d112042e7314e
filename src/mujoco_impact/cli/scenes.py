"""The scene, settings and start that a command was asked for."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import mujoco

from mujoco_impact.calibration.parameters import read_parameters
from mujoco_impact.cli.options import STANDARD_INPUT
from mujoco_impact.errors import ConfigError
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.scene import attach, detach
from mujoco_impact.settings import SETTINGS, attributes
from mujoco_impact.source import read_spec
from mujoco_impact.starts import Keyframe, settled
from mujoco_impact.text import closest


def read_scene(
    model: str, *, timestep: float | None = None, integrator: str | None = None
) -> mujoco.MjSpec:
    """Returns the scene of a file, of a shipped name or of standard input.

    Args:
        model: File, name or "-".
        timestep: Instead of that of the model [s].
        integrator: Instead of that of the model, as MJCF spells it.
    """
    spec = read_spec(_text() if model == STANDARD_INPUT else model)
    if timestep is not None:
        if not 0 < timestep < float("inf"):
            raise ConfigError(f"--timestep {timestep}: must be a time > 0 [s]")
        spec.option.timestep = timestep
    if integrator is not None:
        spec.option.integrator = _integrator(integrator)
    return spec


def scene_of(
    model: str,
    settings: dict[str, Any],
    *,
    native: bool,
    timestep: float | None = None,
    integrator: str | None = None,
    speed_option: str = "--speed",
) -> mujoco.MjSpec:
    """Returns the scene to run, with the plugin or, `native`, without it.

    A scene that has the plugin already keeps it as it is.

    Args:
        model: File, name or "-".
        settings: What `attach` is given.
        native: Whether to leave all contacts to MuJoCo.
        timestep: Instead of that of the model [s].
        integrator: Instead of that of the model, as MJCF spells it.
        speed_option: What the command calls the closing speed that is expected.
    """
    spec = read_scene(model, timestep=timestep, integrator=integrator)
    present = owned_geoms(spec)
    if settings and (present or native):
        reason = "it runs with --native" if native else "it has the plugin already"
        given = _options_of(settings, speed_option)
        raise ConfigError(f"{given} cannot change {model!r}: {reason}")
    if not 0 < settings.get("speed", 1.0) < float("inf"):
        msg = f"{speed_option} {settings['speed']}: must be a speed > 0 [m/s]"
        raise ConfigError(msg)
    if native:
        return detach(spec) if present else spec
    return spec if present else attach(spec, **settings)


def parsed_settings(
    settings: list[str] | None,
    params: Path | None = None,
    *,
    friction: bool = False,
    **attach_options: Any,
) -> dict[str, Any]:
    """Returns what `attach` is given: a file of parameters, then KEY=VALUE.

    Args:
        settings: Texts KEY=VALUE.
        params: File of parameters.
        friction: Whether to take its friction factors, too.
        **attach_options: What else `attach` takes; None is left out.
    """
    parsed: dict[str, Any] = {}
    if friction and params is None:
        raise ConfigError("--friction needs --params, which has its factors")
    if params is not None:
        found = read_parameters(params)
        parsed |= {"law": "calibrated", **found.settings}
        if friction:
            parsed |= found.friction
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not (key and equals and value):
            msg = f"--set {setting!r}: must be KEY=VALUE, such as restitution=0.9"
            raise ConfigError(msg)
        parsed[key.strip()] = value.strip()
    _check_friction(parsed.get("friction", ""))
    # other arguments of `attach` are no settings
    attributes(parsed)
    given = {name: one for name, one in attach_options.items() if one is not None}
    return given | parsed


def assigned(materials: list[str] | None) -> dict[str, str] | None:
    """Returns the material of each geom by its name, of texts GEOM=NAME."""
    result: dict[str, str] = {}
    for text in materials or []:
        geom, equals, name = text.rpartition("=")
        if not (geom and equals and name):
            msg = f"--material {text!r}: must be GEOM=NAME, such as 'ball*=rubber'"
            raise ConfigError(msg)
        if result.setdefault(geom, name) != name:
            msg = (
                f"--material: {geom!r} is of {result[geom]!r} and of {name!r}; give one"
            )
            raise ConfigError(msg)
    return result or None


def _check_friction(value: str) -> None:
    """Raises ConfigError if a coefficient is given for the model of friction."""
    try:
        float(value)
    except ValueError:
        return
    allowed = SETTINGS["friction"].partition(": ")[2]
    msg = (
        f"--set friction={value}: must be {allowed}; coefficients are those of the "
        "scene, the attribute friction of its geoms"
    )
    raise ConfigError(msg)


def geom_names(geoms: str | None) -> list[str] | None:
    """Returns names separated by commas."""
    return None if geoms is None else [name.strip() for name in geoms.split(",")]


def start_keyframe(spec: mujoco.MjSpec, keyframe: str | None) -> Keyframe:
    """Returns the keyframe to start from: its number, or "none"."""
    names = [key.name for key in spec.keys]
    asked: Keyframe = keyframe
    if keyframe is not None and keyframe not in names and keyframe.isdecimal():
        asked = int(keyframe)
    return settled(names, asked)


def _options_of(settings: dict[str, Any], speed_option: str) -> str:
    """Returns the options of the command line that gave these settings."""
    options = {"geoms": "--geoms", "gap": "--gap", "speed": speed_option}
    others = [option for name, option in options.items() if name in settings]
    given = ["--set, --params"] if len(settings) > len(others) else []
    return ", ".join(given + others)


def _text() -> str:
    """Returns what stands on standard input."""
    try:
        return sys.stdin.read()
    except UnicodeDecodeError as error:
        msg = "standard input is not a model: it is not text in UTF-8"
        raise ConfigError(msg) from error


def _integrator(name: str) -> mujoco.mjtIntegrator:
    """Returns an integrator by the name that it has in MJCF."""
    known = {
        one.removeprefix("mjINT_").lower(): number
        for one, number in mujoco.mjtIntegrator.__members__.items()
    }
    if name.lower() not in known:
        shown = [{"euler": "Euler", "rk4": "RK4"}.get(one, one) for one in known]
        raise ConfigError(f"there is no integrator {name!r}{closest(name, shown)}")
    return known[name.lower()]
