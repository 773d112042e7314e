"""Elastic spheres and planes in space: the Hertz problem of an impact, integrated.

Every sphere moves with a constant acceleration of its own until contacts push it: force
K delta^1.5 along the line of centres or the normal of a plane, without friction. A
sphere may be held to directions, such as that of a slide joint. DOP853, independent of
the plugin and of MuJoCo.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mujoco_impact.reference.chain import ChainError, FloatArray, hertz_stiffness

#: Overlap below which spheres count as touching, over the smallest radius.
TOUCH = 1e-12

#: Overlap at the start over the smallest radius that is rounding of positions.
MOST_OVERLAP = 1e-6

#: More contacts in a row than this mean that the spheres stay together.
MOST_CONTACTS = 50


@dataclass(frozen=True)
class Sphere:
    """One sphere.

    Attributes:
        mass: Mass [kg].
        radius: Radius [m].
        position: Centre [m], shape (3,).
        velocity: Velocity [m/s], shape (3,).
        acceleration: Without contacts [m/s²], shape (3,).
        directions: Directions in which it can move, of length 1 and at right angles to
            each other, shape (k, 3).
    """

    mass: float
    radius: float
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    directions: FloatArray


@dataclass(frozen=True)
class Plane:
    """A fixed half-space.

    Attributes:
        point: A point of its surface [m], shape (3,).
        normal: Outwards, of length 1, shape (3,).
    """

    point: FloatArray
    normal: FloatArray


def sphere_velocities(
    spheres: Sequence[Sphere],
    planes: Sequence[Plane],
    duration: float,
    *,
    young: float = 2e11,
    poisson: float = 0.3,
    rtol: float = 1e-11,
) -> FloatArray:
    """Return the velocities of spheres after some time [m/s], shape (n, 3).

    Args:
        spheres: The spheres at time 0.
        planes: What they may hit beside each other.
        duration: Time to cover [s]; contacts under way then come to their end.
        young: Young's modulus of all [Pa].
        poisson: Poisson's ratio of all.
        rtol: Relative tolerance of the integration.

    Raises:
        ChainError: The spheres overlap at the start, do not separate, or the
            integration fails.
    """
    problem = _Problem(spheres, planes, young, poisson, rtol)
    state, now = problem.start(), 0.0
    overlap = problem.overlap(state)
    if overlap > MOST_OVERLAP * min(one.radius for one in spheres):
        raise ChainError(f"the spheres overlap by {overlap:.3g} m at the start")
    for _ in range(MOST_CONTACTS):
        wait = problem.time_to_contact(state, duration - now)
        if wait is None:
            return problem.fly(state, duration - now)[1]
        state = problem.contact(np.concatenate(problem.fly(state, wait)).ravel())
        now += wait + float(state[-1])
        state = state[:-1]
        if now >= duration:
            # back to the time asked for, without the contacts that are over
            return problem.fly(state, duration - now)[1]
    raise ChainError(f"the spheres stay together: {MOST_CONTACTS} contacts at {now} s")


class _Problem:
    """Spheres and planes with their contacts; a state is positions, velocities."""

    def __init__(
        self,
        spheres: Sequence[Sphere],
        planes: Sequence[Plane],
        young: float,
        poisson: float,
        rtol: float,
    ) -> None:
        self._spheres, self._planes, self._rtol = spheres, planes, rtol
        self._count = len(spheres)
        self._radius = np.array([one.radius for one in spheres])
        self._mass = np.array([one.mass for one in spheres])
        self._free = np.array([one.acceleration for one in spheres])
        self._mobility = np.array(
            [one.directions.T @ one.directions / one.mass for one in spheres]
        )
        pairs = list(itertools.combinations(range(self._count), 2))
        self._first = np.array([pair[0] for pair in pairs], dtype=int)
        self._second = np.array([pair[1] for pair in pairs], dtype=int)
        self._pair_stiffness = np.array(
            [
                hertz_stiffness(self._radius[i], self._radius[j], young, poisson)
                for i, j in pairs
            ]
        )
        modulus = young / (2 * (1 - poisson**2))
        self._plane_stiffness = 4 / 3 * modulus * np.sqrt(self._radius)
        self._touch = TOUCH * float(self._radius.min())

    def start(self) -> FloatArray:
        """Return the state at time 0."""
        position = [one.position for one in self._spheres]
        velocity = [one.velocity for one in self._spheres]
        return np.array([position, velocity], dtype=float).ravel()

    def fly(self, state: FloatArray, time: float) -> tuple[FloatArray, FloatArray]:
        """Return positions and velocities after a flight."""
        x, v = state.reshape(2, self._count, 3)
        return x + time * v + time**2 / 2 * self._free, v + time * self._free

    def overlap(self, state: FloatArray) -> float:
        """Return the deepest overlap of a state [m], 0 if nothing overlaps."""
        pairs, planes = self.gaps(state[: 3 * self._count].reshape(-1, 3))
        return max(0.0, -float(np.concatenate([pairs, planes.ravel(), [0.0]]).min()))

    def gaps(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the gaps of pairs (p,) and of spheres to planes (planes, n) [m]."""
        between = x[self._second] - x[self._first]
        reach = self._radius[self._first] + self._radius[self._second]
        pairs = np.linalg.norm(between, axis=1) - reach
        planes = [(x - one.point) @ one.normal - self._radius for one in self._planes]
        return pairs, np.array(planes).reshape(len(self._planes), self._count)

    def time_to_contact(self, state: FloatArray, horizon: float) -> float | None:
        """Return when the first contact closes in free flight, None: not in time."""
        x, v = state.reshape(2, self._count, 3)
        waits = []
        for i, j in zip(self._first, self._second, strict=True):
            reach = self._radius[i] + self._radius[j]
            waits.append(
                _first_meeting(x[j] - x[i], v[j] - v[i], self._free[j] - self._free[i],
                               reach, horizon, self._touch)
            )  # fmt: skip
        for one in self._planes:
            for i in range(self._count):
                gap = float((x[i] - one.point) @ one.normal - self._radius[i])
                rate = float(v[i] @ one.normal)
                pull = float(self._free[i] @ one.normal)
                waits.append(_first_landing(gap, rate, pull, horizon, self._touch))
        known = [wait for wait in waits if wait is not None]
        return min(known) if known else None

    def contact(self, state: FloatArray) -> FloatArray:
        """Return the state after all contacts are open again, and how long it took."""
        from scipy.integrate import solve_ivp

        def pressed(_: float, y: FloatArray) -> float:
            pairs, planes = self.gaps(y[: 3 * self._count].reshape(-1, 3))
            return float(-np.concatenate([pairs, planes.ravel()]).min() - self._touch)

        pressed.terminal = True  # type: ignore[attr-defined]
        pressed.direction = -1  # type: ignore[attr-defined]
        speed = float(np.abs(state[3 * self._count :]).max())
        stiffest = float(
            max([*self._pair_stiffness, *self._plane_stiffness], default=1.0)
        )
        depth = (float(self._mass.max()) * speed**2 / stiffest) ** 0.4
        time = depth / speed
        scale = np.repeat([depth, speed], 3 * self._count)
        solution = solve_ivp(
            self._rates,
            (0.0, 1e4 * time),
            state,
            method="DOP853",
            rtol=self._rtol,
            atol=self._rtol * scale,
            first_step=1e-3 * time,
            max_step=0.1 * time,
            events=pressed,
        )
        if solution.status != 1:
            raise ChainError(f"the spheres do not separate: {solution.message}")
        return np.append(solution.y[:, -1], solution.t[-1])

    def _rates(self, _: float, state: FloatArray) -> FloatArray:
        """Return velocities and accelerations."""
        x, v = state.reshape(2, self._count, 3)
        force = np.zeros((self._count, 3))
        between = x[self._second] - x[self._first]
        distance = np.linalg.norm(between, axis=1)
        pairs, planes = self.gaps(x)
        for k in np.flatnonzero(pairs < 0):
            push = self._pair_stiffness[k] * (-pairs[k]) ** 1.5 / distance[k]
            force[self._first[k]] -= push * between[k]
            force[self._second[k]] += push * between[k]
        for plane, gaps in zip(self._planes, planes, strict=True):
            for i in np.flatnonzero(gaps < 0):
                force[i] += self._plane_stiffness[i] * (-gaps[i]) ** 1.5 * plane.normal
        pushed = np.einsum("nij,nj->ni", self._mobility, force)
        return np.concatenate((v, self._free + pushed)).ravel()


def _first_meeting(
    between: FloatArray,
    speed: FloatArray,
    pull: FloatArray,
    reach: float,
    horizon: float,
    touch: float,
) -> float | None:
    """Return when two spheres meet: |b + v t + a t²/2| = reach, coming closer."""
    b, v, a = between, speed, 0.5 * pull
    polynomial = [
        float(a @ a),
        float(2 * (v @ a)),
        float(v @ v + 2 * (b @ a)),
        float(2 * (b @ v)),
        float(b @ b - reach**2),
    ]
    gap = math.sqrt(float(b @ b)) - reach
    if gap <= touch:
        return 0.0 if b @ v < 0 else _later(polynomial, horizon)
    return _later(polynomial, horizon)


def _first_landing(
    gap: float, rate: float, pull: float, horizon: float, touch: float
) -> float | None:
    """Return when a sphere lands on a plane: g + g' t + g'' t²/2 = 0, coming closer."""
    if gap <= touch:
        return 0.0 if rate < 0 else _later([pull / 2, rate, gap], horizon)
    return _later([pull / 2, rate, gap], horizon)


def _later(polynomial: Sequence[float], horizon: float) -> float | None:
    """Return the first root where a polynomial falls through 0, None: not in time."""
    while polynomial and polynomial[0] == 0:
        polynomial = polynomial[1:]
    if len(polynomial) < 2:
        return None
    slope = np.polyder(np.array(polynomial))
    roots = [
        float(root.real)
        for root in np.roots(polynomial)
        if abs(root.imag) < 1e-12 * (1 + abs(root.real))
        and 1e-12 < root.real <= horizon
        and np.polyval(slope, root.real) < 0
    ]
    return min(roots) if roots else None
