"""The settings of the impact law: names, allowed values, text for MJCF."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from types import MappingProxyType
from typing import TypeAlias

from mujoco_impact.errors import ConfigError
from mujoco_impact.text import as_number, closest

Setting: TypeAlias = str | float | bool | Iterable[float]
"""A value of one setting: text, a number, a flag or a list of numbers."""

DEFAULT_YOUNG = 2e11
"""Young's modulus of the plugin if the setting is absent: steel [Pa]."""

DEFAULT_POISSON = 0.3
"""Poisson's ratio of the plugin if the setting is absent: steel."""

SETTINGS: Mapping[str, str] = MappingProxyType(
    {
        "law": "hertz | calibrated",
        "restitution": "coefficient of restitution of every contact, 0 to 1",
        "dissipation": "how energy is lost for e < 1: bistiffness | viscous",
        "young": "Young's modulus of the balls [Pa], > 0",
        "poisson": "Poisson's ratio, > -1 and <= 0.5",
        "duration": "of the waveform: hertz | paper | a time [s] > 0",
        "touch": "largest gap that counts as touching [m], 0 to 1e-3",
        "tolerance": "of the integration of an impact, relative, 1e-12 to 1e-2",
        "passive": "never create energy: true | false",
        "alpha": "calibrated law: one factor per neighbouring pair of owned geoms",
        "sh": "calibrated law: height factor S_h",
        "sw": "calibrated law: duration factor S_w",
        "w0": "calibrated law: duration at zero mass and speed [s]",
        "kappa": "calibrated law: unit factor of the S_w term",
        "e": "calibrated law: restitution of the waveform",
        "friction": "tangential impulses: coulomb, by MuJoCo's contacts | none | paper",
        "mu_s": "friction=paper: static factor of equation (7), >= 0",
        "mu_d": "friction=paper: dynamic factor of equation (9), >= 0",
    }
)
"""Name and meaning of each configuration attribute of the engine plugin."""


LIST = "alpha"
"""The setting that is a list of numbers, and an empty one with a single owned geom."""


def attributes(settings: Mapping[str, Setting]) -> dict[str, str]:
    """Converts settings to the text attributes of the engine plugin.

    Only names and types are checked here; ranges are checked by the plugin, which
    is the single place that knows them.

    Args:
        settings: Values by name, see `SETTINGS`.

    Returns:
        Attribute text by name: numbers with all their digits, flags as
        "true"/"false", sequences separated by spaces.

    Raises:
        ConfigError: If a name is unknown or a value has no text form.
    """
    return {key: _text(_known(key), value) for key, value in settings.items()}


def _known(key: str) -> str:
    """Returns the key, or raises ConfigError with the nearest known name."""
    if key in SETTINGS:
        return key
    raise ConfigError(f"unknown setting {key!r}{closest(key, SETTINGS)}")


def _text(key: str, value: Setting) -> str:
    """Returns the attribute text of one value."""
    if isinstance(value, str) and (value or key == LIST):
        return value
    # bool is a number in Python: flags come first; numpy's bool has no base class
    if isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"):
        return "true" if value else "false"
    number = as_number(value)
    if number is not None:
        return repr(number)
    is_no_list = isinstance(value, bytes | Mapping)
    if key == LIST and isinstance(value, Iterable) and not is_no_list:
        with suppress(TypeError):  # an array without a dimension
            return " ".join(_text(key, item) for item in value)
    kinds = "numbers" if key == LIST else "text, a number or a flag"
    msg = f"setting {key!r} = {value!r} must be {kinds} ({key}: {SETTINGS[key]})"
    raise ConfigError(msg)
