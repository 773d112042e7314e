"""Ways of making a case of shapes simpler, to find the least that breaks a promise."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from functools import partial

from mujoco_impact_lab.stress.shapes.case import Case, Tree

SIMPLER: tuple[tuple[str, object], ...] = (
    ("floor", "none"),
    ("floor", "plane"),
    ("gravity", 0.0),
    ("spin", 0.0),
    ("offset", 0.0),
    ("mass_ratio", 1.0),
    ("materials", 0),
    ("materials", 1),
    ("condim", 1),
    ("cone", "pyramidal"),
    ("jacobian", "dense"),
    ("integrator", "Euler"),
    ("restitution", 1.0),
    ("restitution", 0.0),
    ("timestep", 2e-3),
    ("size", 0.1),
    ("density", 1000.0),
    ("clearance", 0.1),
    ("pace", 0.1),
)
"""Fields, and what is simpler; the most telling first."""

ALL_SIMPLER = ("box", "sphere")
"""Shapes that are simpler than the others, the simplest last."""

SIMPLER_SHAPES = {"sphere": (), "box": ("sphere",)}
"""The same for themselves."""

SHORTER = (2, 2, 2, 4, 4, 8, 8)
"""Parts of the steps to take away, in turn."""


def simplifications(case: Case) -> Iterator[Callable[[Case], Case]]:
    """Yields ways of making a case simpler; one that does not apply changes nothing."""
    for part in SHORTER:
        yield partial(_shorter, part)
    for tree in case.trees:
        yield partial(_without, tree.number)
        yield partial(_tree_changed, tree.number, {"joint": "free", "links": 1})
        yield partial(_tree_changed, tree.number, {"shapes": tree.shapes[:2]})
        first = tree.shapes[0]
        for shape in dict.fromkeys((first, *SIMPLER_SHAPES.get(first, ALL_SIMPLER))):
            yield partial(_tree_changed, tree.number, {"shapes": (shape,)})
    for field, value in SIMPLER:
        yield partial(_changed, field, value)
    for part in SHORTER:
        yield partial(_shorter, part)


def _shorter(part: int, case: Case) -> Case:
    return dataclasses.replace(case, steps=max(1, case.steps - case.steps // part))


def _without(number: int, case: Case) -> Case:
    trees = tuple(tree for tree in case.trees if tree.number != number)
    return dataclasses.replace(case, trees=trees or case.trees)


def _tree_changed(number: int, changes: dict[str, object], case: Case) -> Case:
    def changed(tree: Tree) -> Tree:
        # mypy: the fields are of several types
        return dataclasses.replace(tree, **changes)  # type: ignore[arg-type]

    trees = (changed(t) if t.number == number else t for t in case.trees)
    return dataclasses.replace(case, trees=tuple(trees))


def _changed(field: str, value: object, case: Case) -> Case:
    return dataclasses.replace(case, **{field: value})  # type: ignore[arg-type]
