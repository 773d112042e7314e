"""What geoms are made of in a case with materials: drawn, and what it means."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from itertools import combinations, combinations_with_replacement
from typing import Any

import numpy as np

from mujoco_impact.materials import Material, MaterialPair
from mujoco_impact_lab.stress.draw import logarithmic
from mujoco_impact_lab.stress.shapes.case import Case

YOUNG = (1e6, 3e11)  # [Pa], rubber to steel and beyond
MODULUS = (1e6, 2e11)  # [Pa], of a pair
POISSON = (0.0, 0.5)
FRICTION = (0.0, 1.5)
LOSS = (0.0, 0.6)  # [(s/m)^(1/5)]
SPEED = (1e-2, 10.0)  # [m/s], of a table
MOST_SPEEDS = 4

SAID = 0.8
"""Part of the properties that a material says."""

ASSIGNED = 0.8
"""Part of the geoms that are of a material."""

PAIRED, PAIRED_GEOMS = 0.2, 0.05
"""Part of the pairs of materials, and of geoms, that have properties of their own."""


@dataclasses.dataclass(frozen=True)
class Materials:
    """What `attach` is told of materials, by its arguments; empty if there are none."""

    materials: Mapping[str, Material]
    assign: Mapping[str, str]
    pairs: Mapping[tuple[str, str], MaterialPair]

    def pair_of(self, one: str, other: str) -> MaterialPair:
        """Returns what is said of two geoms as a pair; it may be nothing."""
        names = (self.assign.get(one, ""), self.assign.get(other, ""))
        for first, second in ((one, other), names):
            for pair in ((first, second), (second, first)):
                if pair in self.pairs:
                    return self.pairs[pair]
        return MaterialPair()

    def each_of(self, one: str, other: str) -> tuple[Material, Material]:
        """Returns what is said of each of two geoms; it may be nothing."""
        first, second = (
            self.materials.get(self.assign.get(geom, ""), Material())
            for geom in (one, other)
        )
        return first, second


def materials_of(
    case: Case, geoms: Sequence[str], *, renamed: bool = False
) -> Materials:
    """Returns the materials of a case.

    Each is drawn from a stream of its own: it stays what it is without the others.

    Args:
        case: The case.
        geoms: Names of its geoms.
        renamed: Whether to say the same with the names the other way round.
    """
    numbers = range(case.materials)
    names = [f"material{number}" for number in numbers]
    if renamed:
        names.reverse()
    assign = {}
    for geom in geoms if case.materials else ():
        random = np.random.default_rng((case.seed, 5, *geom.encode()))
        if random.random() < ASSIGNED:
            assign[geom] = names[random.integers(case.materials)]
    if not assign:
        return Materials({}, {}, {})
    pairs = {}
    for i, j in combinations_with_replacement(numbers, 2):
        random = np.random.default_rng((case.seed, 6, i, j))
        if random.random() < PAIRED:
            pairs[names[i], names[j]] = _pair(random)
    for one, other in combinations(geoms, 2):
        random = np.random.default_rng((case.seed, 7, *f"{one} {other}".encode()))
        if random.random() < PAIRED_GEOMS:
            pairs[(other, one) if renamed else (one, other)] = _pair(random)
    materials = {
        names[number]: _material(np.random.default_rng((case.seed, 8, number)))
        for number in numbers
    }
    return Materials(materials, assign, pairs)


def restitution_at(speed: float, said: Material | MaterialPair) -> float | None:
    """Returns the e that is said at a closing speed [m/s], None if none is."""
    if said.restitution_loss is not None:
        return max(0.0, 1 - said.restitution_loss * math.pow(max(0.0, speed), 0.2))
    if said.restitution_table is not None:
        speeds = sorted(said.restitution_table)
        values = [said.restitution_table[u] for u in speeds]
        return float(np.interp(speed, speeds, values))
    return said.restitution


def _material(random: np.random.Generator) -> Material:
    """Returns a material, some of whose properties are left to the settings."""
    return Material(
        **_some(
            random,
            young=logarithmic(random, *YOUNG),
            poisson=random.choice((*POISSON, random.uniform(*POISSON))),
            friction=random.choice((0.0, random.uniform(*FRICTION))),
            **_restitution(random),
        )
    )


def _pair(random: np.random.Generator) -> MaterialPair:
    """Returns what counts between two, some of it left to what follows from each."""
    return MaterialPair(
        **_some(
            random,
            modulus=logarithmic(random, *MODULUS),
            friction=random.choice((0.0, random.uniform(*FRICTION))),
            **_restitution(random),
        )
    )


def _restitution(random: np.random.Generator) -> dict[str, Any]:
    """Returns one of the three kinds of restitution, by its name."""
    kind = random.integers(4)
    if kind < 2:
        return {"restitution": random.choice((0.0, 1.0, random.random()))}
    if kind == 2:
        return {"restitution_loss": random.uniform(*LOSS)}
    count = random.integers(1, MOST_SPEEDS, endpoint=True)
    return {
        "restitution_table": {
            logarithmic(random, *SPEED): random.random() for _ in range(count)
        }
    }


def _some(random: np.random.Generator, **properties: Any) -> dict[str, Any]:
    """Returns some of the properties."""
    return {key: value for key, value in properties.items() if random.random() < SAID}
