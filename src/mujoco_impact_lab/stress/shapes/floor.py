"""The floors of a case of shapes, and how high above one a point is."""

from __future__ import annotations

import dataclasses

import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.shapes.case import Case

TILT = 0.5
"""Steepest tilt of a plane [rad]."""

NODES = 12
"""Nodes of a height field along a side."""

SIDE = 12.0
"""Half of the side of a floor that ends, over the usual half-width of a geom."""


@dataclasses.dataclass(frozen=True, eq=False)
class Floor:
    """A floor.

    Attributes:
        normal: Upwards out of it, shape (3,).
        level: Of its highest point along the normal [m].
        side: Half of its side [m]; infinite for a plane.
        elevation: Of the nodes of a height field below its highest point [m], shape
            (n along y, n along x); None for what is flat.
    """

    normal: Array
    level: float
    side: float
    elevation: Array | None = None

    def height(self, points: Array) -> Array:
        """Returns how high points are above it [m]; NaN beside it.

        Args:
            points: [m], shape (..., 3).
        """
        above = points @ self.normal - self.level
        if self.elevation is not None:
            above -= self._surface(points)
        beside = np.abs(points[..., :2]).max(axis=-1) > self.side
        result: Array = np.where(beside, np.nan, above)
        return result

    def _surface(self, points: Array) -> Array:
        """Returns the surface of a height field, bilinear in each of its cells [m]."""
        assert self.elevation is not None
        last = len(self.elevation) - 1
        grid = (points[..., :2] / self.side + 1) / 2 * last
        grid = np.clip(grid, 0, last)
        cell = np.minimum(grid.astype(int), last - 1)
        u, v = np.moveaxis(grid - cell, -1, 0)
        i, j = np.moveaxis(cell, -1, 0)
        e = self.elevation
        low = e[j, i] * (1 - u) + e[j, i + 1] * u
        high = e[j + 1, i] * (1 - u) + e[j + 1, i + 1] * u
        result: Array = low * (1 - v) + high * v
        return result


def floor_of(case: Case, centres: Array, reaches: Array) -> Floor | None:
    """Returns the floor below balls, None if there is none.

    Args:
        case: The case.
        centres: Of the balls [m], shape (n, 3).
        reaches: Their radii [m], shape (n,).
    """
    if case.floor == "none":
        return None
    random = np.random.default_rng((case.seed, 2))
    normal = np.array([0.0, 0.0, 1.0])
    if case.floor == "tilted plane":
        tilt, around = random.uniform(0, TILT), random.uniform(0, 2 * np.pi)
        level_part = np.array([np.cos(around), np.sin(around)])
        normal = np.array([*(np.sin(tilt) * level_part), np.cos(tilt)])
    level = float((centres @ normal - reaches).min()) - case.clearance * case.size
    if case.floor.endswith("plane"):
        return Floor(normal, level, np.inf)
    side = SIDE * case.size + float(np.abs(centres).max())
    if case.floor == "box":
        return Floor(normal, level, side)
    depth = case.size * random.uniform(0.1, 1.0)
    elevation = random.random((NODES, NODES))
    elevation = (elevation - elevation.min()) / np.ptp(elevation) - 1
    return Floor(normal, level, side, depth * elevation)


def floor_mjcf(floor: Floor | None) -> tuple[str, str]:
    """Returns the floor's geom and its assets as MJCF."""
    if floor is None:
        return "", ""
    where = " ".join(repr(float(x)) for x in floor.level * floor.normal)
    if np.isinf(floor.side):
        axis = " ".join(repr(float(x)) for x in floor.normal)
        return (
            f'<geom name="floor" type="plane" size="1 1 1" pos="{where}" '
            f'zaxis="{axis}"/>',
            "",
        )
    side = floor.side
    if floor.elevation is None:
        below = floor.level - side / 10
        return (
            f'<geom name="floor" type="box" size="{side!r} {side!r} {side / 10!r}" '
            f'pos="0 0 {below!r}"/>',
            "",
        )
    depth = -float(floor.elevation.min())
    # MJCF has the first row at the far side
    values = " ".join(repr(float(x)) for x in floor.elevation[::-1].ravel())
    return (
        f'<geom name="floor" type="hfield" hfield="ground" '
        f'pos="0 0 {floor.level - depth!r}"/>',
        f'<hfield name="ground" nrow="{NODES}" ncol="{NODES}" elevation="{values}" '
        f'size="{side!r} {side!r} {depth!r} {side / 10!r}"/>',
    )
