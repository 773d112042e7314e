"""What a sweep can set and vary: names, units, and which values are allowed.

A parameter is called as it is written in the specification: `timestep`, or
`attach.restitution` for `restitution` in the table `[attach]`.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, TypeAlias

import cradle_models
from mujoco_impact.baselines import baselines
from mujoco_impact.comparison import OURS
from mujoco_impact.errors import ConfigError
from mujoco_impact.files import quoted
from mujoco_impact.settings import SETTINGS
from mujoco_impact.stress.variations import INTEGRATORS
from mujoco_impact.text import closest

Value: TypeAlias = str | bool | int | float | list[Any]
"""A value of a parameter, as TOML has it."""

ITSELF = "itself"
"""Value of `tuned_for`: MuJoCo's settings are tuned for the speed of the case."""

BUILDERS: Mapping[str, Callable[..., str]] = MappingProxyType(
    {
        builder.__name__: builder
        for builder in (
            cradle_models.row,
            cradle_models.two_string,
            cradle_models.lattice,
            cradle_models.force_sensor,
            cradle_models.free_balls,
            cradle_models.billiards,
            cradle_models.spinning_balls,
            cradle_models.dominoes,
            cradle_models.rocking_block,
            cradle_models.cannon,
            cradle_models.bernoulli,
        )
    }
)
"""The functions that make scenes, by name."""

ATTACH: Mapping[str, str] = MappingProxyType(
    {
        "geoms": "names of the geoms whose impacts are ours",
        "gap": "how early a contact is seen [m]",
        "depth": "overlap at which MuJoCo's own contact takes over [m]",
        "speed": "closing speed of the fastest impact expected [m/s]",
        **SETTINGS,
    }
)
"""What `attach` takes, and what it means."""

SINGLE: Mapping[str, str] = MappingProxyType(
    {
        "method": "what computes the impacts",
        "duration": "simulated time [s]",
        "keyframe": "name or number of the keyframe to start from",
        "timestep": "timestep [s]",
        "integrator": "integrator of MuJoCo",
        "speed_factor": "all velocities at the start times this",
        "tuned_for": "impact speed that MuJoCo's settings are tuned for [m/s]",
    }
)
"""Parameters that stand alone, and what they mean."""

SECTIONS: Mapping[str, str] = MappingProxyType(
    {
        "scene": "model, or builder and its arguments",
        "attach": "arguments of attach",
        "mass": "mass of a geom [kg]",
        "qpos": "position of a joint at the start [m or rad]",
        "qvel": "velocity of a joint at the start [m/s or rad/s]",
    }
)
"""Tables of parameters, and what stands in them."""

_UNIT = re.compile(r"\[([^\]]+)\]")


@cache
def methods() -> tuple[str, ...]:
    """Returns the names of what can compute impacts: ours first, then MuJoCo's."""
    tuned = baselines("<mujoco/>", impact_speed=1.0)
    return (OURS, *(method.name for method in tuned))


def flattened(
    table: Mapping[str, Any], where: str, *, also: Sequence[str] = ()
) -> dict[str, Any]:
    """Returns what a table of the specification says of each parameter.

    Args:
        table: The table; those of `SECTIONS` in it may be tables themselves.
        where: What the table is called, for messages.
        also: What else may stand in it.

    Raises:
        ConfigError: If a parameter has a name that there is not, or is given twice.
    """
    found: dict[str, Any] = {}
    for key, value in table.items():
        if key in SECTIONS:
            if not isinstance(value, Mapping):
                msg = (
                    f"{where}{key} = {quoted(value)}: must be a table, {SECTIONS[key]}"
                )
                raise ConfigError(msg)
            named = {f"{key}.{name}": one for name, one in value.items()}
        else:
            named = {key: value}
        for name, one in named.items():
            if name in found:
                raise ConfigError(f"{where}{name} is given twice: give it once")
            if name not in also:
                _check_name(name, where)
            found[name] = one
    return found


def _check_name(name: str, where: str) -> None:
    """Raises ConfigError if there is no such parameter."""
    section, dot, rest = name.partition(".")
    if name in SINGLE or (dot and section in ("mass", "qpos", "qvel") and rest):
        return
    if section == "attach" and rest:
        if rest not in ATTACH:
            msg = f"{where}{name}: attach has no {rest!r}{closest(rest, ATTACH)}"
            raise ConfigError(msg)
        return
    # which arguments a builder has is known once the builder is
    if section == "scene" and rest:
        return
    known = [*SINGLE, *(f"{one}.NAME" for one in SECTIONS)]
    known += [f"attach.{one}" for one in ATTACH]
    msg = f"{where}{name}: there is no such parameter{closest(name, known)}"
    raise ConfigError(msg)


def check_builder(builder: str, options: Sequence[str]) -> None:
    """Raises ConfigError if a scene cannot be built with some arguments.

    Args:
        builder: Name of a function of `cradle_models`.
        options: Names of the arguments that it is given.
    """
    if builder not in BUILDERS:
        msg = f"scene.builder = {builder!r}: not there{closest(builder, BUILDERS)}"
        raise ConfigError(msg)
    taken = inspect.signature(BUILDERS[builder]).parameters
    for option in options:
        if option not in taken:
            msg = f"scene.{option}: {builder} has no such argument"
            raise ConfigError(msg + closest(option, taken))
    for option, parameter in taken.items():
        if parameter.default is parameter.empty and option not in options:
            raise ConfigError(f"scene.{option} is missing: {builder} needs it")


def check_value(name: str, value: Any, where: str = "") -> None:
    """Raises ConfigError if a parameter cannot have a value.

    What MuJoCo, `attach` or a builder checks is left to them.

    Args:
        name: The parameter.
        value: The value.
        where: What stands before the name in the specification.
    """
    told = f"{where}{name} = {quoted(value)}"
    if not _is_value(value):
        msg = (
            f"{told}: allowed: text on one line, a finite number, true, false, or a "
            "list of them"
        )
        raise ConfigError(msg)
    if name in ("duration", "timestep") or name.startswith("mass."):
        unit = "mass > 0 [kg]" if name.startswith("mass.") else "time > 0 [s]"
        if not _is_number(value) or value <= 0:
            raise ConfigError(f"{told}: must be a {unit}")
    elif name == "tuned_for":
        if value != ITSELF and not (_is_number(value) and value > 0):
            msg = f"{told}: must be a speed > 0 [m/s], or {ITSELF!r}: that of the case"
            raise ConfigError(msg)
    elif name == "speed_factor":
        if not _is_number(value):
            raise ConfigError(f"{told}: must be a number")
    elif name.startswith(("qpos.", "qvel.")):
        if not all(map(_is_number, value if isinstance(value, list) else [value])):
            raise ConfigError(f"{told}: must be a number or a list of numbers")
    elif name in _CHOICES:
        allowed = _CHOICES[name]()
        if value not in allowed:
            raise ConfigError(f"{told}: not there{closest(str(value), allowed)}")
    elif name == "keyframe":
        if not isinstance(value, str | int) or isinstance(value, bool):
            raise ConfigError(f"{told}: must be a name or a number")
    elif name in ("scene.model", "scene.builder") and not isinstance(value, str):
        raise ConfigError(f"{told}: must be text")


_CHOICES: Mapping[str, Callable[[], Sequence[str]]] = {
    "method": methods,
    "integrator": lambda: tuple(INTEGRATORS),
}


def _is_value(value: Any) -> bool:
    """Returns whether a value can stand in a row."""
    if isinstance(value, list):
        return all(_is_value(one) for one in value)
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, str):
        return value.isprintable()
    return isinstance(value, bool | int)


def _is_number(value: Any) -> bool:
    """Returns whether a value is a number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def unit_of(name: str, builder: str | None = None) -> str:
    """Returns the unit of a parameter as text, "" if it has none.

    Args:
        name: The parameter.
        builder: Function that makes the scene, whose docstring has the units.
    """
    section, _, rest = name.partition(".")
    if section == "attach":
        text = ATTACH[rest]
    elif section == "scene":
        text = _argument_text(builder, rest)
    else:
        text = {**SINGLE, **SECTIONS}[section]
    found = _UNIT.search(text)
    return found[1] if found else ""


def _argument_text(builder: str | None, argument: str) -> str:
    """Returns what the docstring of a builder says of an argument."""
    text = inspect.getdoc(BUILDERS[builder]) if builder else ""
    found = re.search(rf"^    {argument}: (.*(?:\n      .*)*)", text or "", re.M)
    return found[1] if found else ""
