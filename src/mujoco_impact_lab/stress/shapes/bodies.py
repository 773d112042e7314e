"""The trees of a case of shapes as MJCF, and the balls that they fit in."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.shapes.case import Case, Tree

VERTICES = (8, 16)
"""Points of a mesh; its hull has no more corners."""


@dataclasses.dataclass(frozen=True, eq=False)
class Geom:
    """One geom of a body.

    Attributes:
        shape: Its type.
        size: As MJCF has it [m]; empty for a mesh.
        vertices: Of a mesh, relative to the geom [m].
        reach: Radius of a ball about its centre that it fits in [m].
    """

    shape: str
    size: Array
    vertices: Array
    reach: float


@dataclasses.dataclass(frozen=True, eq=False)
class Built:
    """A tree as MJCF.

    Attributes:
        body: Its root body, with its origin at the format field `{pos}`.
        assets: Its meshes.
        centres: Of balls that its bodies fit in, from the root [m], shape (links, 3).
        reaches: Their radii [m], shape (links,).
    """

    body: str
    assets: str
    centres: Array
    reaches: Array


def tree_of(case: Case, tree: Tree) -> Built:
    """Returns a tree, drawn from its own stream of random numbers."""
    random = np.random.default_rng((case.seed, 1, tree.number))
    density = case.density * case.mass_ratio ** random.random()
    along = direction(random)
    texts: list[str] = []
    centres: list[Array] = []
    reaches: list[float] = []
    assets = ""
    position = np.zeros(3)
    for link in range(tree.links):
        text, meshes, reach = _geoms(case, tree, link, density, random)
        if link:
            # the next link goes on nearly straight and stays clear of the one before
            along += 0.3 * direction(random)
            along /= np.linalg.norm(along)
            position = position + 1.05 * along * (reaches[-1] + reach)
        joints = _joints(tree, link, reach * along, random)
        previous = centres[-1] if link else position
        place = _numbers(position - previous) if link else "{pos}"
        texts.append(
            f'<body name="body{tree.number}_{link}" pos="{place}">{joints}{text}'
        )
        assets += meshes
        centres.append(position)
        reaches.append(reach)
    return Built(
        body="".join(texts) + "</body>" * tree.links,
        assets=assets,
        centres=np.array(centres),
        reaches=np.array(reaches),
    )


def direction(random: np.random.Generator) -> Array:
    """Returns a unit vector, all directions alike."""
    vector: Array = random.normal(size=3)
    return vector / np.linalg.norm(vector)


def _geoms(
    case: Case, tree: Tree, link: int, density: float, random: np.random.Generator
) -> tuple[str, str, float]:
    """Returns the geoms of a body, its meshes, and its reach from its origin [m]."""
    text, assets, reach = "", "", 0.0
    offset = case.offset * case.size * direction(random)
    for number, shape in enumerate(tree.shapes):
        half = case.size * random.uniform(0.6, 1.4)
        geom = _BUILDERS[shape](half, random)
        place = offset + (half * random.uniform(0.5, 1.2) if number else 0.0) * (
            direction(random)
        )
        name = f"{tree.number}_{link}_{number}"
        size = f'size="{_numbers(geom.size)}"'
        if shape == "mesh":
            size = f'mesh="mesh{name}"'
            assets += (
                f'<mesh name="mesh{name}" inertia="convex" '
                f'vertex="{_numbers(geom.vertices.ravel())}"/>'
            )
        # a smooth body of half the width has a comparable mass, whatever its shape
        mass = density * 4 / 3 * np.pi * half**3
        text += (
            f'<geom name="geom{name}" type="{shape}" {size} mass="{mass!r}" '
            f'pos="{_numbers(place)}" quat="{_numbers(random.normal(size=4))}"/>'
        )
        reach = max(reach, float(np.linalg.norm(place)) + geom.reach)
    return text, assets, reach


def _joints(tree: Tree, link: int, arm: Array, random: np.random.Generator) -> str:
    """Returns the joints of a body; those of chains are where the link begins."""
    axis = _numbers(direction(random))
    if tree.joint == "free" or (tree.joint == "free chain" and link == 0):
        return "<freejoint/>"
    if "chain" in tree.joint:
        return f'<joint type="hinge" axis="{axis}" pos="{_numbers(-arm)}"/>'
    x, y, z = (f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))
    return {
        "slides": x + y + z,
        "slide": f'<joint type="slide" axis="{axis}"/>',
        "planar": x + z + '<joint type="hinge" axis="0 1 0"/>',
        "hinge": f'<joint type="hinge" axis="{axis}"/>',
        "ball": '<joint type="ball"/>',
    }[tree.joint]


def _sphere(half: float, _random: np.random.Generator) -> Geom:
    return Geom("sphere", np.array([half]), np.empty((0, 3)), half)


def _box(half: float, random: np.random.Generator) -> Geom:
    size = half * random.uniform(0.5, 1.5, size=3)
    return Geom("box", size, np.empty((0, 3)), float(np.linalg.norm(size)))


def _capsule(half: float, random: np.random.Generator) -> Geom:
    size = half * np.array([0.6, random.uniform(0.5, 2.0)])
    return Geom("capsule", size, np.empty((0, 3)), float(size.sum()))


def _cylinder(half: float, random: np.random.Generator) -> Geom:
    size = half * np.array([1.0, random.uniform(0.2, 1.5)])
    return Geom("cylinder", size, np.empty((0, 3)), float(np.linalg.norm(size)))


def _ellipsoid(half: float, random: np.random.Generator) -> Geom:
    size = half * random.uniform(0.5, 1.5, size=3)
    if random.random() < 0.6:
        size[1] = size[0]  # of revolution
    return Geom("ellipsoid", size, np.empty((0, 3)), float(size.max()))


def _mesh(half: float, random: np.random.Generator) -> Geom:
    points = np.array(
        [direction(random) for _ in range(random.integers(*VERTICES, endpoint=True))]
    )
    # six more keep the hull from being flat
    points = np.vstack([points, np.eye(3), -np.eye(3)])
    points *= half * random.uniform(0.6, 1.4, size=3)
    reach = float(np.linalg.norm(points, axis=1).max())
    return Geom("mesh", np.empty(0), points, reach)


def _numbers(values: Array) -> str:
    """Returns numbers as MJCF has them, to the last bit."""
    return " ".join(repr(float(value)) for value in values)


_BUILDERS: dict[str, Callable[[float, np.random.Generator], Geom]] = {
    "sphere": _sphere,
    "box": _box,
    "capsule": _capsule,
    "cylinder": _cylinder,
    "ellipsoid": _ellipsoid,
    "mesh": _mesh,
}
