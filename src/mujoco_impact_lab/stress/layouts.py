"""Where the balls of a case are at the start, and how fast."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.case import Case

APPROACH = (0.0, 4.0)
"""How many steps the first impact is away."""

SPREAD = 0.2
"""Speeds of the balls that do not come in, over the speed of the one that does."""

CLEARANCE, ATTEMPTS = 0.01, 1000
"""Room between balls of a cluster that do not touch, over the smallest radius, and how
often a place with that room is looked for."""

SMALLEST_INERTIA = 1e-13
"""Masses are raised together until every ball has this inertia [kg m^2]: MuJoCo
refuses bodies below 1e-15."""


@dataclasses.dataclass(frozen=True, eq=False)
class Balls:
    """Balls at the start of a case, in the world frame.

    Attributes:
        radius: [m], shape (n,).
        mass: [kg], shape (n,).
        position: Centres [m], shape (n, 3).
        velocity: [m/s], shape (n, 3).
    """

    radius: Array
    mass: Array
    position: Array
    velocity: Array

    def reordered(self, order: npt.NDArray[np.int64]) -> Balls:
        """Returns the balls in another order."""
        return Balls(*(getattr(self, field.name)[order]
                       for field in dataclasses.fields(self)))  # fmt: skip

    def mirrored(self) -> Balls:
        """Returns the mirror image in the plane x = 0."""
        mirror = np.array([-1.0, 1.0, 1.0])
        return dataclasses.replace(
            self, position=self.position * mirror, velocity=self.velocity * mirror
        )


def balls_of(case: Case) -> Balls:
    """Returns the balls of a case."""
    # another stream than the one the case was drawn from
    random = np.random.default_rng((case.seed, 1))
    radius = case.radius / random.uniform(1, case.radius_ratio, size=case.count)
    if case.layout in ("ring", "lattice"):
        radius[:] = case.radius
    mass = _masses(case, radius, random)
    position, direction = _PLACES[case.layout](case, radius, random)
    velocity = np.zeros_like(position)
    if case.joint in ("free", "slides") and "sleep" not in case.features:
        velocity += SPREAD * case.speed * random.uniform(-1, 1, size=3)  # all drift
    velocity[0] += case.speed * direction
    if case.layout == "row" and random.random() < 0.3:
        velocity[-1] -= case.speed * random.uniform(0, 2) * direction
    if "equality" in case.features and case.count > 2:
        velocity[-1] = velocity[0]  # joints that are tied do not start apart
    if case.layout != "row" and "sleep" not in case.features:
        jitter = SPREAD * case.speed * (random.random() < 0.5)
        velocity[1:] += jitter * random.normal(size=(case.count - 1, 3)) / 2
    # the first ball steps back, so that it comes in a few steps later
    away = random.uniform(*APPROACH) * case.speed * case.timestep
    position[0] -= away * direction * (random.random() < 0.8)
    return Balls(radius, mass, position, velocity)


def _masses(case: Case, radius: Array, random: np.random.Generator) -> Array:
    """Returns masses [kg] that span the mass ratio."""
    factor = np.exp(random.uniform(0, np.log(case.mass_ratio), size=case.count))
    if case.mass_ratio > 1:
        low, high = random.permutation(case.count)[:2]
        factor[low], factor[high] = 1.0, case.mass_ratio
    mass: Array = case.density * 4 / 3 * np.pi * np.mean(radius) ** 3 * factor
    smallest = np.min(0.4 * mass * radius**2)
    return mass * max(1.0, SMALLEST_INERTIA / smallest)


def _distance(case: Case, first: float, second: float) -> float:
    """Returns how far apart the centres of two neighbours are [m]."""
    touching = first + second
    return touching * (1 - case.overlap) if case.overlap else touching + case.gap


def _row(case: Case, radius: Array, random: np.random.Generator) -> tuple[Array, Array]:
    """A straight row along x; the first ball comes in from the left."""
    position = np.zeros((case.count, 3))
    for i in range(1, case.count):
        position[i, 0] = position[i - 1, 0] + _distance(case, radius[i - 1], radius[i])
    direction = np.array([1.0, 0.0, 0.0])
    if case.joint in ("free", "slides") and random.random() < 0.5:
        # an oblique blow
        direction[1:] = random.uniform(-0.4, 0.4, size=2)
        direction /= np.linalg.norm(direction)
    return position, direction


def _ring(
    case: Case, radius: Array, random: np.random.Generator
) -> tuple[Array, Array]:
    """A closed ring of neighbours; the first ball is pushed along it, and sideways."""
    n = case.count
    angle = 2 * np.pi * np.arange(n) / n
    around = _distance(case, radius[0], radius[0]) / (2 * np.sin(np.pi / n))
    position = around * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    direction = np.array([random.uniform(-0.5, 0.5), 1.0, 0.0])
    return position, direction / np.linalg.norm(direction)


def _lattice(
    case: Case, radius: Array, random: np.random.Generator
) -> tuple[Array, Array]:
    """A square or cubic grid; the first ball comes at it from a random side."""
    pitch = _distance(case, radius[0], radius[0])
    dimensions = 2 if random.random() < 0.5 else 3
    side = int(np.ceil((case.count - 1) ** (1 / dimensions))) if case.count > 1 else 1
    grid = np.indices((side,) * dimensions).reshape(dimensions, -1).T[: case.count - 1]
    position = np.zeros((case.count, 3))
    position[1:, :dimensions] = pitch * grid
    target = 1 + int(random.integers(case.count - 1))
    direction = np.array([1.0, *random.uniform(-0.3, 0.3, size=2)])
    direction /= np.linalg.norm(direction)
    position[0] = _in_front(case, radius, position, target, direction)
    return position, direction


def _cluster(
    case: Case, radius: Array, random: np.random.Generator
) -> tuple[Array, Array]:
    """Each ball touches one that is there already, and stays clear of the others."""
    position = np.zeros((case.count, 3))
    for i in range(2, case.count):
        partners = position[1:i]
        for attempt in itertools.count():
            partner = 1 + random.integers(i - 1)
            outwards = random.normal(size=3)
            outwards /= np.linalg.norm(outwards)
            place = position[partner] + outwards * _distance(
                case, radius[partner], radius[i]
            )
            clear = np.linalg.norm(partners - place, axis=1) - radius[1:i] - radius[i]
            clear[partner - 1] = np.inf
            # where overlaps leave no room beside a ball, it overlaps more than one
            if attempt == ATTEMPTS or np.all(clear > CLEARANCE * radius.min()):
                break
        position[i] = place
    direction = random.normal(size=3)
    direction /= np.linalg.norm(direction)
    target = 1 + int(random.integers(max(1, case.count - 1)))
    position[0] = _in_front(case, radius, position, target, direction)
    return position, direction


def _in_front(
    case: Case, radius: Array, position: Array, target: int, direction: Array
) -> Array:
    """Returns where the first ball is as it meets the others on its way to a target.

    It comes along `direction` towards the centre of the target and stops at the first
    ball that it touches.
    """
    others = position[1:]
    reach = np.array([_distance(case, radius[0], r) for r in radius[1:]])
    towards = others - position[target]
    along = towards @ direction
    across2 = np.einsum("ij,ij->i", towards, towards) - along**2
    hit = across2 < reach**2
    stop = np.min(along[hit] - np.sqrt(reach[hit] ** 2 - across2[hit]))
    place: Array = position[target] + stop * direction
    return place


_Place = Callable[[Case, Array, np.random.Generator], tuple[Array, Array]]
_PLACES: dict[str, _Place] = {
    "row": _row,
    "ring": _ring,
    "lattice": _lattice,
    "cluster": _cluster,
}
