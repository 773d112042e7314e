"""A case that breaks a promise, made as simple as it can be while it still does."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator

from mujoco_impact.stress.shapes.case import Case, Tree

SIMPLER: tuple[tuple[str, object], ...] = (
    ("floor", "none"),
    ("floor", "plane"),
    ("gravity", 0.0),
    ("spin", 0.0),
    ("offset", 0.0),
    ("mass_ratio", 1.0),
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
"""Fields and what is simpler, the most telling first."""

SIMPLER_SHAPES = ("sphere", "box")


def shrunk(case: Case, breaks: Callable[[Case], bool]) -> Case:
    """Returns the simplest case found that still breaks.

    Args:
        case: One that breaks.
        breaks: Whether a case does.
    """
    for _ in range(4):
        before = case
        for candidate in _candidates(case):
            simpler = candidate(case)
            if simpler is not None and simpler != case and breaks(simpler):
                case = simpler
        if case == before:
            break
    return case


def _candidates(case: Case) -> Iterator[Callable[[Case], Case | None]]:
    """Yields the ways of making a case simpler."""
    for tree in case.trees:
        number = tree.number
        yield lambda c, n=number: _with_tree(c, n, None)
        yield lambda c, n=number: _with_tree(c, n, {"links": 1, "joint": "free"})
        yield lambda c, n=number: _with_tree(c, n, {"joint": "free"})
        for _ in tree.shapes[1:]:
            yield lambda c, n=number: _with_tree(c, n, {"shapes": slice(0, -1)})
        for shape in SIMPLER_SHAPES:
            yield lambda c, n=number, s=shape: _with_tree(c, n, {"shapes": (s,)})
    for field, value in SIMPLER:
        yield lambda c, f=field, v=value: dataclasses.replace(c, **{f: v})
    for _ in range(6):
        yield lambda c: dataclasses.replace(c, steps=max(1, c.steps // 2))
        yield lambda c: dataclasses.replace(c, steps=max(1, c.steps * 3 // 4))


def _with_tree(case: Case, number: int, changes: dict[str, object] | None) -> Case | None:
    """Returns a case with one of its trees changed, or taken away."""
    trees: list[Tree] = []
    for tree in case.trees:
        if tree.number != number:
            trees.append(tree)
        elif changes is not None:
            shapes = changes.get("shapes", tree.shapes)
            if isinstance(shapes, slice):
                shapes = tree.shapes[shapes]
            trees.append(dataclasses.replace(tree, **{**changes, "shapes": shapes}))  # type: ignore[arg-type]
    if not trees or any(not tree.shapes for tree in trees):
        return None
    return dataclasses.replace(case, trees=tuple(trees))
