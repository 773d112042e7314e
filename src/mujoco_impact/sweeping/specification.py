"""What a sweep was asked for: reading it, checking it, listing its cases."""

from __future__ import annotations

import dataclasses
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from mujoco_impact.comparison import OURS
from mujoco_impact.errors import ConfigError
from mujoco_impact.files import quoted, read_text
from mujoco_impact.sweeping.cases import (
    NUMBERS,
    Values,
    combined,
    grid_cases,
    list_cases,
    random_cases,
)
from mujoco_impact.sweeping.parameters import (
    ATTACH,
    ITSELF,
    SECTIONS,
    SINGLE,
    Value,
    check_builder,
    check_value,
    flattened,
)
from mujoco_impact.sweeping.quantities import check_recorded
from mujoco_impact.text import closest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Given: TypeAlias = str | os.PathLike[str] | Mapping[str, Any]
"""A file of a specification, or what stands in one."""

MOST_REPEATS = 10_000
"""Most repeats of a case."""

MOST_ROWS = 1_000_000
"""Most rows of a sweep, which are held in memory: cases times repeats."""

_TABLES = ("grid", "list", "random", "plot")
_KEYS = ("record", "repeats", *_TABLES, *SINGLE, *SECTIONS)
_PLOT = ("x", "y", "title")
_DEFAULTS: Values = {"method": OURS, "tuned_for": ITSELF, "speed_factor": 1.0}


@dataclasses.dataclass(frozen=True)
class Specification:
    """What a sweep was asked for.

    Attributes:
        fixed: Parameters that all cases share.
        tables: What the tables `grid`, `list` and `random` say of each parameter;
            that of `random` has `cases` and `seed`, too.
        varied: Names of the parameters that cases do not share, in order.
        cases: All parameters of each case.
        record: What to record of each, see `quantities.QUANTITIES`.
        repeats: How often each case is run.
        plot: What `plot` draws: "x" and "y", names of columns, and a "title".
        folder: Where files of models are, unless their path says so.
    """

    fixed: Values
    tables: Mapping[str, Mapping[str, Any]]
    varied: tuple[str, ...]
    cases: tuple[Values, ...]
    record: tuple[str, ...]
    repeats: int = 1
    plot: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    folder: Path = dataclasses.field(default_factory=Path.cwd)

    @property
    def builder(self) -> str | None:
        """Name of the function that makes the scenes, None if files are read."""
        found = self.cases[0].get("scene.builder")
        return str(found) if found is not None else None


def read_specification(given: Given) -> Specification:
    """Returns a specification that has been read and checked.

    Args:
        given: A TOML file, in which paths of models are relative to its folder, or
            what would stand in it.

    Raises:
        ConfigError: If it cannot be read, or something in it is not valid; names the
            key, its value and what is allowed.
    """
    if isinstance(given, Mapping):
        return _checked(given, Path.cwd())
    path = Path(given)
    text = read_text(path, what="a specification of a sweep", error=ConfigError)
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{path} is not valid TOML: {error}") from error
    try:
        return _checked(document, path.resolve().parent)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from error


def _checked(document: Mapping[str, Any], folder: Path) -> Specification:
    """Returns the specification of a document."""
    for key in document:
        if key.partition(".")[0] not in _KEYS:
            known = [*_KEYS, *(f"attach.{one}" for one in ATTACH)]
            raise ConfigError(f"there is no key {key!r}{closest(key, known)}")
    tables = {
        "random": flattened(_table(document, "random"), "random.", also=NUMBERS),
        "grid": flattened(_table(document, "grid"), "grid."),
        "list": flattened(_table(document, "list"), "list."),
    }
    plot = _table(document, "plot")
    given = {
        key: value
        for key, value in document.items()
        if key not in (*_TABLES, "record", "repeats")
    }
    fixed: Values = flattened(given, "")
    for name, value in fixed.items():
        check_value(name, value)
    groups = {
        "random": random_cases(tables["random"]),
        "grid": grid_cases(tables["grid"]),
        "list": list_cases(tables["list"]),
    }
    _check_once(fixed, groups)
    cases = [_DEFAULTS | fixed | case for case in combined(*groups.values())]
    _check_scenes(cases)
    repeats = _repeats(document.get("repeats", 1))
    if (rows := len(cases) * repeats) > MOST_ROWS:
        msg = f"repeats = {repeats}: {len(cases)} cases have {rows} rows"
        raise ConfigError(f"{msg}, allowed: {MOST_ROWS}")
    varied = tuple(name for group in groups.values() for name in group[0])
    return Specification(
        fixed=fixed,
        tables=tables,
        varied=varied,
        cases=tuple(cases),
        record=_record(document.get("record")),
        repeats=repeats,
        plot=_plot(plot),
        folder=folder,
    )


def _table(document: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """Returns a table of a document, empty if it is not there."""
    table = document.get(name, {})
    if not isinstance(table, Mapping):
        raise ConfigError(f"{name} = {quoted(table)}: must be a table")
    return table


def _check_once(fixed: Values, groups: Mapping[str, Sequence[Values]]) -> None:
    """Raises ConfigError if a parameter is given in two places."""
    places = dict.fromkeys(fixed, "a fixed value")
    for table, cases in groups.items():
        for name in cases[0]:
            if name in places:
                msg = f"{name} has {places[name]} and stands in [{table}]: give one"
                raise ConfigError(msg)
            places[name] = f"values in [{table}]"


def _check_scenes(cases: Sequence[Values]) -> None:
    """Raises ConfigError if a case has no scene, or no duration."""
    seen: set[tuple[Value | None, ...]] = set()
    for case in cases:
        model, builder = case.get("scene.model"), case.get("scene.builder")
        options = [
            name.partition(".")[2]
            for name in case
            if name.startswith("scene.")
            and name not in ("scene.model", "scene.builder")
        ]
        kind = (str(model), str(builder), *options)
        if kind in seen:
            continue
        seen.add(kind)
        if (model is None) == (builder is None):
            msg = (
                "scene: give either model, a file or the name of a shipped model, or "
                "builder, a function of cradle_models"
            )
            raise ConfigError(msg)
        if "duration" not in case:
            raise ConfigError("duration is missing: a time > 0 [s]")
        if builder is not None:
            check_builder(str(builder), options)
        elif options:
            msg = (
                f"scene.{options[0]}: {model!r} is a model, and only a builder has "
                "arguments; allowed: model"
            )
            raise ConfigError(msg)


def _record(given: Any) -> tuple[str, ...]:
    """Returns what to record."""
    if isinstance(given, str):
        given = [given]
    if not isinstance(given, list) or not given:
        what = "is missing" if given is None else f"= {quoted(given)}"
        raise ConfigError(f"record {what}: must be a list of what to record")
    for name in given:
        check_recorded(name)
    return tuple(dict.fromkeys(given))


def _repeats(given: Any) -> int:
    """Returns the number of repeats."""
    whole = isinstance(given, int) and not isinstance(given, bool)
    if not whole or not 1 <= given <= MOST_REPEATS:
        msg = f"repeats = {quoted(given)}: must be a whole number, 1 to {MOST_REPEATS}"
        raise ConfigError(msg)
    return int(given)


def _plot(given: Mapping[str, Any]) -> dict[str, Any]:
    """Returns what to draw; which columns there are is known later."""
    for key, value in given.items():
        if key not in _PLOT:
            raise ConfigError(f"plot.{key}: not there{closest(key, _PLOT)}")
        texts = value if isinstance(value, list) else [value]
        if not all(isinstance(one, str) for one in texts):
            raise ConfigError(f"plot.{key} = {quoted(value)}: must be text")
    return dict(given)
