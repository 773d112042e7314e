"""Materials of geoms: what bodies are made of, by name, and which geoms are of which.

`attach(scene, materials=..., assign=..., pairs=...)` takes them. The rule by which two
materials combine is in `docs/materials.md`, and so are the sources of `MATERIALS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TypeAlias, TypeVar

from mujoco_impact.errors import ConfigError
from mujoco_impact.text import as_number, closest

Table: TypeAlias = Mapping[float, float]
"""Restitution by closing speed [m/s]: linear between its speeds, constant beyond."""

T = TypeVar("T", "Material", "MaterialPair")


@dataclass(frozen=True, kw_only=True)
class Material:
    """What bodies are made of. What is None is as the settings of `attach` have it.

    Of the three kinds of restitution give one.

    Attributes:
        restitution: e of two bodies of this material [-], 0 to 1.
        restitution_loss: c of e = 1 - c u^(1/5) [(s/m)^(1/5)] >= 0, u the closing speed
            in m/s: the law of viscoelastic spheres to first order (Kuwabara and Kono
            1987).
        restitution_table: e by closing speed [m/s], such as {0.1: 0.95, 2: 0.8}; linear
            between the speeds, constant beyond; up to 16 of them.
        young: Young's modulus [Pa] > 0.
        poisson: Poisson's ratio [-], > -1 and <= 0.5.
        friction: Coefficient of friction in impacts [-] >= 0, instead of that of the
            geom; at rest and rolling MuJoCo's own counts.
    """

    restitution: float | None = None
    restitution_loss: float | None = None
    restitution_table: Table | None = None
    young: float | None = None
    poisson: float | None = None
    friction: float | None = None


@dataclass(frozen=True, kw_only=True)
class MaterialPair:
    """What counts between two materials. What is None follows from each of them.

    Attributes:
        restitution: e [-], 0 to 1.
        restitution_loss: See `Material`.
        restitution_table: See `Material`.
        friction: Coefficient of friction in impacts [-] >= 0.
        modulus: Contact modulus E* [Pa] > 0, 1/E* the sum of both (1 - ν²)/E.
    """

    restitution: float | None = None
    restitution_loss: float | None = None
    restitution_table: Table | None = None
    friction: float | None = None
    modulus: float | None = None


MATERIALS: Mapping[str, Material] = MappingProxyType(
    {
        "cloth": Material(restitution=0.5, young=1e7, poisson=0.3, friction=0.2),
        "cork": Material(restitution=0.5, young=3e7, poisson=0.2),
        "cushion": Material(restitution=0.85, young=2e6, poisson=0.49, friction=0.14),
        "glass": Material(restitution=0.97, young=7e10, poisson=0.2, friction=0.092),
        "phenolic": Material(
            restitution=0.95, young=5.84e9, poisson=0.34, friction=0.05
        ),
        "rubber": Material(restitution=0.83, young=2e6, poisson=0.49),
        "steel": Material(restitution=0.95, young=2e11, poisson=0.3),
        "wood": Material(restitution=0.6, young=1e9, poisson=0.3),
    }
)
"""Materials that `attach(assign=...)` knows by name.

`docs/materials.md` has the source of each number. `phenolic` is a billiard ball, and
`cloth` lies on the slate of its table."""


def read_materials(
    given: Mapping[str, Material | Mapping[str, object]],
) -> dict[str, Material]:
    """Returns materials by name, those given as mappings read.

    Raises:
        ConfigError: If a name cannot be one, or a key is unknown.
    """
    for name in given:
        if not isinstance(name, str) or not name or set(name) & set(" \t\n;="):
            msg = (
                f"materials: {name!r} is no name of a material; allowed: text without "
                "spaces, semicolons and equals signs"
            )
            raise ConfigError(msg)
    return {
        name: _read(Material, f"material {name!r}", one) for name, one in given.items()
    }


def read_pair(names: tuple[str, str], given: object) -> MaterialPair:
    """Returns what is said of a pair, read if it is given as a mapping."""
    return _read(MaterialPair, f"pair {names!r}", given)


def entry(name: str, properties: Material | MaterialPair) -> str:
    """Returns the entry of the attribute `materials` or `material_pairs`.

    Args:
        name: Name of the material, or both names of the pair with a space between.
        properties: What is said of it.
    """
    words = [name]
    for field in fields(properties):
        value = getattr(properties, field.name)
        if value is not None:
            words.append(f"{field.name}={_text(name, field.name, value)}")
    return " ".join(words)


def _read(kind: type[T], label: str, given: object) -> T:
    """Returns a `Material` or `MaterialPair` as given or from a mapping."""
    if isinstance(given, kind):
        return given
    if not isinstance(given, Mapping):
        msg = f"{label} = {given!r}: must be a {kind.__name__} or a dict of the same"
        raise ConfigError(msg)
    known = [field.name for field in fields(kind)]
    for key in given:
        if key not in known:
            raise ConfigError(f"{label} has no {key!r}{closest(str(key), known)}")
    return kind(**given)


def _text(name: str, key: str, value: object) -> str:
    """Returns the text of a number or a table; ranges are checked by the plugin."""
    if isinstance(value, Mapping):
        points = sorted(
            (_number(name, key, u), _number(name, key, e)) for u, e in value.items()
        )
        return ",".join(f"{_short(u)}:{_short(e)}" for u, e in points)
    return _short(_number(name, key, value))


def _short(number: float) -> str:
    """Returns the text of a number, short if that loses nothing."""
    short = f"{number:g}"
    return short if float(short) == number else repr(number)


def _number(name: str, key: str, value: object) -> float:
    number = as_number(value)
    if number is not None:
        return number
    msg = f"{name!r}: {key} = {value!r} must be a number"
    raise ConfigError(
        msg + (", or numbers by speed" if key == "restitution_table" else "")
    )
