"""The cases of a sweep: every combination of a grid, of lists, and of random draws."""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from mujoco_impact.errors import ConfigError
from mujoco_impact.files import quoted
from mujoco_impact.sweeping.parameters import Value, check_value

Values = dict[str, Value]
"""A value for each of some parameters."""

MOST_CASES = 1_000_000
"""Most cases of a sweep."""

NUMBERS = ("cases", "seed")
"""What stands in the table `[random]` besides parameters."""

LARGEST_SEED = 2**32 - 1
"""Largest seed of random draws."""

_RANGE = ("from", "to", "count", "spacing")
_SPACINGS = ("linear", "log")


def grid_cases(table: Mapping[str, Any]) -> list[Values]:
    """Returns every combination of the values of a table, the last one fastest.

    Args:
        table: What the table `[grid]` says of each parameter: a list of values, or a
            range { from = 1, to = 8, count = 4, spacing = "log" }.
    """
    axes = {name: grid_values(name, given, "grid.") for name, given in table.items()}
    _check_count(math.prod(len(axis) for axis in axes.values()))
    return [
        dict(zip(axes, values, strict=True))
        for values in itertools.product(*axes.values())
    ]


def list_cases(table: Mapping[str, Any]) -> list[Values]:
    """Returns the first values of all parameters of a table, then the second, ...

    Args:
        table: What the table `[list]` says of each parameter: as many values as of the
            others.
    """
    columns = {name: grid_values(name, given, "list.") for name, given in table.items()}
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        shown = ", ".join(f"{name} has {count}" for name, count in lengths.items())
        raise ConfigError(f"list: {shown} values; all must have as many")
    return [
        dict(zip(columns, values, strict=True))
        for values in zip(*columns.values(), strict=True)
    ] or [{}]


def random_cases(table: Mapping[str, Any]) -> list[Values]:
    """Returns random draws, the same ones for the same seed.

    The draws of a parameter depend on the seed and its name alone: another parameter
    or more cases leave them as they are.

    Args:
        table: What the table `[random]` says: `cases`, how many; `seed`; and of each
            parameter { uniform = [0, 1] }, { log_uniform = [1, 100] } or
            { choice = [...] }.
    """
    if not table:
        return [{}]
    count = _whole(table.get("cases"), "random.cases", 1, MOST_CASES)
    seed = _whole(table.get("seed"), "random.seed", 0, LARGEST_SEED)
    drawn = {
        name: _draws(name, how, count, seed)
        for name, how in table.items()
        if name not in NUMBERS
    }
    if not drawn:
        raise ConfigError("random: no parameter to draw stands in it")
    return [
        {name: values[number] for name, values in drawn.items()}
        for number in range(count)
    ]


def combined(*groups: Sequence[Values]) -> list[Values]:
    """Returns every combination of cases of several groups, the last one fastest."""
    _check_count(math.prod(len(group) for group in groups))
    found: list[Values] = []
    for parts in itertools.product(*groups):
        case: Values = {}
        for part in parts:
            case |= part
        found.append(case)
    return found


def grid_values(name: str, given: Any, where: str) -> list[Value]:
    """Returns the values of a parameter, written as a list or as a range."""
    told = f"{where}{name} = {quoted(given)}"
    if isinstance(given, Mapping):
        values = _range(given, told)
    elif isinstance(given, list) and given:
        values = given
    else:
        msg = (
            f"{told}: must be a list of values, or a range such as "
            "{ from = 1, to = 8, count = 4 }"
        )
        raise ConfigError(msg)
    for value in values:
        check_value(name, value, where)
    return alike(values)


def alike(values: Sequence[Value]) -> list[Value]:
    """Returns values, all numbers as floats if one of them is, as a column has them."""
    if any(isinstance(value, float) for value in values):
        return [
            float(value)
            if isinstance(value, int) and not isinstance(value, bool)
            else value
            for value in values
        ]
    return list(values)


def _range(given: Mapping[str, Any], told: str) -> list[Value]:
    """Returns the values of a range."""
    unknown = [key for key in given if key not in _RANGE]
    missing = [key for key in _RANGE[:3] if key not in given]
    spacing = given.get("spacing", "linear")
    if unknown or missing or spacing not in _SPACINGS:
        msg = (
            f"{told}: a range has from, to, count, and spacing if it is not "
            f"'linear': 'log'"
        )
        raise ConfigError(msg)
    low, high = _ends([given["from"], given["to"]], told, log=spacing == "log")
    count = _whole(given["count"], f"{told}: count", 2, MOST_CASES)
    if spacing == "log":
        points = np.geomspace(low, high, count)
    else:
        points = np.linspace(low, high, count)
    return [float(point) for point in points]


def _draws(name: str, how: Any, count: int, seed: int) -> list[Value]:
    """Returns the draws of one parameter."""
    told = f"random.{name} = {quoted(how)}"
    if not (
        isinstance(how, Mapping) and len(how) == 1 and next(iter(how)) in _DISTRIBUTIONS
    ):
        shown = " or ".join(f"{{ {one} = [...] }}" for one in _DISTRIBUTIONS)
        raise ConfigError(f"{told}: must be {shown}")
    kind, ends = next(iter(how.items()))
    # from the name, so that a parameter more leaves the draws of the others alone
    stream = np.random.default_rng([seed, zlib.crc32(name.encode())])
    values = _DISTRIBUTIONS[kind](ends, stream.random(count), told)
    for value in values:
        check_value(name, value, "random.")
    return alike(values)


def _uniform(ends: Any, draws: Any, told: str) -> list[Value]:
    """Returns numbers of which each is as likely as any other."""
    low, high = _ends(ends, told)
    return [low + (high - low) * float(draw) for draw in draws]


def _log_uniform(ends: Any, draws: Any, told: str) -> list[Value]:
    """Returns numbers of which each order of magnitude is as likely as any other."""
    low, high = _ends(ends, told, log=True)
    return [low * (high / low) ** float(draw) for draw in draws]


def _choice(values: Any, draws: Any, told: str) -> list[Value]:
    """Returns members of a list."""
    if not isinstance(values, list) or not values:
        raise ConfigError(f"{told}: must be a list of values")
    return [values[int(draw * len(values))] for draw in draws]


_DISTRIBUTIONS: Mapping[str, Callable[[Any, Any, str], list[Value]]] = MappingProxyType(
    {"uniform": _uniform, "log_uniform": _log_uniform, "choice": _choice}
)
"""How parameters can be drawn, from numbers of 0 to 1."""


def _ends(ends: Any, told: str, *, log: bool = False) -> tuple[float, float]:
    """Returns the two ends of a range."""
    numbers = isinstance(ends, list) and all(
        isinstance(end, int | float) and not isinstance(end, bool) for end in ends
    )
    if not numbers or len(ends) != 2 or not all(map(math.isfinite, ends)):
        raise ConfigError(f"{told}: must go from one number to another")
    if log and min(ends) <= 0:
        raise ConfigError(f"{told}: both ends must be > 0")
    return float(ends[0]), float(ends[1])


def _whole(value: Any, told: str, low: int, high: int) -> int:
    """Returns a whole number within bounds."""
    if value is None:
        raise ConfigError(f"{told} is missing: a whole number, {low} to {high}")
    whole = isinstance(value, int) and not isinstance(value, bool)
    if not whole or not low <= value <= high:
        msg = f"{told} = {quoted(value)}: must be a whole number, {low} to {high}"
        raise ConfigError(msg)
    return int(value)


def _check_count(count: int) -> None:
    """Raises ConfigError if there are too many cases."""
    if count > MOST_CASES:
        raise ConfigError(f"there are {count} cases, allowed: {MOST_CASES}")
