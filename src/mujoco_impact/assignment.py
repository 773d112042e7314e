"""Which geoms are of which material, and the pairs that have properties of their own.

Pairs may name materials or geoms. The model holds pairs of materials alone: names of
geoms change when a model is attached to another. So a geom that a pair names gets a
material of its own, with the properties of the one it is of.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import combinations_with_replacement
from typing import Any

import mujoco

from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.materials import (
    MATERIALS,
    Material,
    MaterialPair,
    entry,
    read_materials,
    read_pair,
)
from mujoco_impact.text import closest

Materials = Mapping[str, Material | Mapping[str, Any]]
Pairs = Mapping[tuple[str, str], MaterialPair | Mapping[str, Any]]

WILD = frozenset("*?[")
"""A key of `assign` with one of these is a pattern."""


@dataclass(frozen=True)
class Assignment:
    """Materials of a scene, as the plugin takes them.

    Attributes:
        config: Attributes of the instance, by name.
        numbers: Number of the material by name of the geom, from 1.
    """

    config: Mapping[str, str]
    numbers: Mapping[str, int]


def assign_materials(
    spec: mujoco.MjSpec,
    materials: Materials | None,
    assign: Mapping[str, str] | None,
    pairs: Pairs | None,
) -> Assignment:
    """Returns which geoms are of which material, see `attach`.

    Raises:
        ConfigError: If a material or a pair cannot be read, or there is none of a name.
        SceneError: If there is no geom of a name.
    """
    for label, given in (
        ("materials", materials),
        ("assign", assign),
        ("pairs", pairs),
    ):
        if given is not None and not isinstance(given, Mapping):
            raise ConfigError(f"{label} = {given!r}: must be a dict, by names")
    own = read_materials(materials or {})
    known = {**MATERIALS, **own}
    geoms = [geom.name for geom in spec.geoms if geom.name]
    of_geom = _materials_of_geoms(geoms, assign or {}, known)
    if own and not of_geom:
        msg = (
            f"materials = {', '.join(own)}: no geom is of them; say which, such as "
            f"assign={{{(geoms or ['ball'])[0]!r}: {min(own)!r}}}"
        )
        raise ConfigError(msg)
    used = {name: known[name] for name in {*of_geom.values(), *own}}
    said = _read_pairs(pairs or {}, geoms, known, used)
    singled = {name for names in said for name in names if name not in used}
    base = {name: name for name in used}
    for geom in sorted(singled):
        name = _own_name(geom, used)
        base[name] = of_geom.get(geom, "")
        used[name] = known.get(base[name], Material())
        of_geom[geom] = name
    own_name = {geom: of_geom[geom] for geom in singled}
    texts = _pair_entries(said, base, {name: geom for geom, name in own_name.items()})
    order = sorted(used)
    config = {
        "materials": "; ".join(entry(name, used[name]) for name in order),
        "material_pairs": "; ".join(texts),
    }
    return Assignment(
        {key: text for key, text in config.items() if text},
        {geom: 1 + order.index(name) for geom, name in of_geom.items()},
    )


def _materials_of_geoms(
    geoms: Sequence[str], assign: Mapping[str, str], known: Mapping[str, Material]
) -> dict[str, str]:
    """Returns the material of each geom; a name counts more than a pattern."""
    result: dict[str, str] = {}
    said_by: dict[str, str] = {}
    if not all(isinstance(key, str) for key in assign):
        msg = f"assign={assign!r} must be names of geoms with those of their materials"
        raise ConfigError(msg)
    for key, material in assign.items():
        if not isinstance(material, str):
            msg = (
                f"assign: {key!r} needs the name of a material, not {material!r}; give "
                f"your own in materials={{'mine': ...}} and assign={{{key!r}: 'mine'}}"
            )
            raise ConfigError(msg)
        if material not in known:
            msg = f"assign: geom {key!r} is of no known material {material!r}"
            raise ConfigError(msg + closest(str(material), known))
        wild = bool(set(key) & WILD) and key not in geoms
        found = [
            name for name in geoms if (fnmatchcase(name, key) if wild else name == key)
        ]
        if not found:
            msg = f"assign: there is no geom {key!r}{closest(key, geoms)}"
            raise SceneError(msg)
        for geom in found:
            other = said_by.get(geom)
            if other is None or (other != geom and not wild):
                result[geom], said_by[geom] = material, key
            elif wild and other != geom and result[geom] != material:
                msg = (
                    f"assign: geom {geom!r} is of {result[geom]!r} by {other!r} and of "
                    f"{material!r} by {key!r}; give it by its own name"
                )
                raise ConfigError(msg)
    return result


def _read_pairs(
    pairs: Pairs,
    geoms: Sequence[str],
    known: Mapping[str, Material],
    used: dict[str, Material],
) -> dict[tuple[str, str], MaterialPair]:
    """Returns the pairs by their names in order; adds the materials that they name.

    A name is that of a material if geoms are of it, or else of a geom, or else of any
    known material.
    """
    result: dict[tuple[str, str], MaterialPair] = {}
    for key, given in pairs.items():
        if isinstance(key, str) or not isinstance(key, tuple) or len(key) != 2:
            msg = f"pairs: {key!r} must be two names, such as ('cue', 'cushion')"
            raise ConfigError(msg)
        for name in key:
            if name in used or name in geoms:
                continue
            if name not in known:
                msg = f"pairs: {name!r} of {key!r} is neither a material nor a geom"
                raise ConfigError(msg + closest(str(name), [*known, *geoms]))
            used[name] = known[name]
        first, second = sorted(key)
        if (first, second) in result:
            raise ConfigError(f"pairs: {first!r} and {second!r} are given twice")
        result[first, second] = read_pair((first, second), given)
    return result


def _own_name(geom: str, used: Mapping[str, Material]) -> str:
    """Returns the name of the material that a geom has to itself."""
    name = "geom:" + re.sub(r"[\s;=]", "_", geom)
    while name in used:
        name += "_"
    return name


def _pair_entries(
    said: Mapping[tuple[str, str], MaterialPair],
    base: Mapping[str, str],
    geom_of: Mapping[str, str],
) -> list[str]:
    """Returns the entries of `material_pairs`.

    Args:
        said: What is said of pairs of materials and geoms, by names in order.
        base: By name of a material the one whose properties it has.
        geom_of: The geom whose own a material is.
    """
    entries = []
    for one, other in combinations_with_replacement(sorted(base), 2):
        # what is said of a geom counts more than what is said of its material
        levels: list[list[tuple[str, str]]] = [[], [], []]
        for i, first in enumerate((geom_of.get(one), base[one])):
            for j, second in enumerate((geom_of.get(other), base[other])):
                if first and second:
                    names = (min(first, second), max(first, second))
                    levels[i + j].append(names)
        for level in levels:
            found = {names: said[names] for names in level if names in said}
            if len(set(map(repr, found.values()))) > 1:
                msg = (
                    f"pairs: {geom_of[one]!r} and {geom_of[other]!r} are of two pairs, "
                    f"{' and '.join(map(repr, found))}; give the pair of both"
                )
                raise ConfigError(msg)
            if found:
                entries.append(entry(f"{one} {other}", next(iter(found.values()))))
                break
    return entries
