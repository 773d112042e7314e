"""The scene, settings and start that a command was asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco

import cradle_models
from mujoco_impact.calibration.parameters import read_parameters
from mujoco_impact.cli.options import START_KEYFRAME
from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.scene import attach, detach
from mujoco_impact.settings import attributes
from mujoco_impact.source import read_spec


def model_path(model: str) -> Path:
    """Returns the file of a model given by path or by shipped name."""
    path = Path(model)
    if path.is_file():
        return path
    if model in cradle_models.list_models():
        return cradle_models.model_path(model)
    msg = (
        f"there is no model file {model!r} and no shipped model of that name "
        f"(available: {', '.join(cradle_models.list_models())})"
    )
    raise SceneError(msg)


def scene_of(model: str, settings: dict[str, Any], *, native: bool) -> mujoco.MjSpec:
    """Returns the scene to run, with the plugin or, `native`, without it.

    A scene that has the plugin already keeps it as it is.
    """
    spec = read_spec(model_path(model))
    present = owned_geoms(spec)
    if settings and (present or native):
        reason = "it runs with --native" if native else "it has the plugin already"
        msg = f"--set, --params and --speed have no effect on {model!r}: {reason}"
        raise ConfigError(msg)
    if native:
        return detach(spec) if present else spec
    return spec if present else attach(spec, **settings)


def parsed_settings(
    settings: list[str] | None,
    params: Path | None = None,
    *,
    friction: bool = False,
    speed: float | None = None,
) -> dict[str, Any]:
    """Returns what `attach` is given: a file of parameters, then KEY=VALUE.

    Args:
        settings: Texts KEY=VALUE.
        params: File of parameters.
        friction: Whether to take its friction factors, too.
        speed: See `attach`.
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
    # other arguments of `attach` are no settings
    attributes(parsed)
    return parsed if speed is None else {"speed": speed, **parsed}


def start_keyframe(spec: mujoco.MjSpec, keyframe: str | None) -> str | int | None:
    """Returns the keyframe to start from."""
    names = [key.name for key in spec.keys]
    if keyframe is None:
        return START_KEYFRAME if START_KEYFRAME in names else None
    if keyframe in names:
        return keyframe
    if keyframe == "none":
        return None
    return int(keyframe) if keyframe.isdecimal() else keyframe
