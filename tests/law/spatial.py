"""Islands of free bodies in space, with the tangential rows of their contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from mujoco_impact import law

STIFFNESS = 1.2e10  # [N/m^1.5]


@dataclass(frozen=True)
class Body:
    """A free body: mass [kg], inertia in the world frame [kg m^2], velocities."""

    mass: float
    inertia: np.ndarray  # (3, 3)
    position: np.ndarray  # (3,) [m]
    velocity: np.ndarray  # (3,) [m/s]
    spin: np.ndarray  # (3,) [rad/s]


class Touch(NamedTuple):
    """Two bodies, -1 is the ground, that touch; the normal points to the second."""

    first: int
    second: int
    point: np.ndarray
    normal: np.ndarray
    turn: float = 0.0  # of the tangents about the normal [rad]


def ball(mass, radius, position, velocity=(0, 0, 0), spin=(0, 0, 0)) -> Body:
    inertia = 0.4 * mass * radius**2 * np.eye(3)
    return Body(
        mass, inertia, *(np.array(x, dtype=float) for x in (position, velocity, spin))
    )


def frame(normal: np.ndarray, turn: float) -> np.ndarray:
    """Rows n, t1, t2."""
    n = np.asarray(normal, dtype=float)
    across = np.eye(3)[np.argmin(np.abs(n))]
    t1 = np.cross(n, across) / np.linalg.norm(np.cross(n, across))
    t1 = Rotation.from_rotvec(turn * n).apply(t1)
    return np.array([n, t1, np.cross(n, t1)])


@dataclass(frozen=True)
class Island:
    """Rows of all contacts: n, t1, t2 of contact 0, of contact 1, ..."""

    bodies: tuple[Body, ...]
    jacobian: np.ndarray  # (3 n, 6 bodies): velocities, then spins, of each body
    inverse_inertia: np.ndarray  # (6 bodies, 6 bodies)
    motion: np.ndarray  # (6 bodies,)

    @property
    def delassus(self) -> np.ndarray:
        W = self.jacobian @ self.inverse_inertia @ self.jacobian.T
        W[np.abs(W) < 1e-14 * np.abs(W).max()] = 0  # rounding is no coupling
        return (W + W.T) / 2

    @property
    def velocity(self) -> np.ndarray:
        return (self.jacobian @ self.motion).reshape(-1, 3)

    @property
    def fastest(self) -> float:
        return float(np.linalg.norm(self.velocity, axis=1).max())

    def solve(self, mu, *, stiffness=STIFFNESS, **options) -> law.FrictionSolution:
        return law.solve_impact_with_friction(
            self.delassus, self.velocity, stiffness, mu, **options
        )

    def after(self, impulse) -> np.ndarray:
        """Velocity and spin of each body after the impact, (bodies, 6)."""
        change = self.inverse_inertia @ self.jacobian.T @ np.ravel(impulse)
        return (self.motion + change).reshape(-1, 6)

    def energy(self, motion) -> float:
        v = np.ravel(motion)
        return float(v @ np.linalg.solve(self.inverse_inertia, v)) / 2


def island(bodies: list[Body], touches: list[Touch]) -> Island:
    J = np.zeros((3 * len(touches), 6 * len(bodies)))
    for k, touch in enumerate(touches):
        axes = frame(touch.normal, touch.turn)
        for sign, b in ((-1, touch.first), (1, touch.second)):
            if b < 0:
                continue
            arm = np.asarray(touch.point, dtype=float) - bodies[b].position
            J[3 * k : 3 * k + 3, 6 * b : 6 * b + 3] = sign * axes
            J[3 * k : 3 * k + 3, 6 * b + 3 : 6 * b + 6] = sign * np.cross(arm, axes)
    inverse = np.zeros((6 * len(bodies),) * 2)
    for b, body in enumerate(bodies):
        inverse[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = np.eye(3) / body.mass
        inverse[6 * b + 3 : 6 * b + 6, 6 * b + 3 : 6 * b + 6] = np.linalg.inv(
            body.inertia
        )
    motion = np.concatenate([[*body.velocity, *body.spin] for body in bodies])
    return Island(tuple(bodies), J, inverse, motion)


def box_on_ground(half, quaternion, velocity, spin, *, mass=1.0) -> Island:
    """A box of half-sizes [m] that touches the ground with its lowest corners.

    Args:
        half: Half-sizes along its axes [m].
        quaternion: Of its axes in the world, (w, x, y, z).
        velocity: Of its centre [m/s], world frame.
        spin: [rad/s], world frame.
        mass: [kg].
    """
    half = np.asarray(half)
    R = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    corners = (signs * half) @ R.T
    lowest = corners[corners[:, 2] < corners[:, 2].min() + 1e-6]
    inertia = mass / 3 * R @ np.diag(half @ half - half**2) @ R.T
    centre = np.array([0, 0, -corners[:, 2].min()])
    body = Body(mass, inertia, centre, np.array(velocity), np.array(spin))
    ground = [Touch(-1, 0, [x, y, 0], [0, 0, 1]) for x, y, _ in lowest]
    return island([body], ground)


def touching_balls(radius: float, bodies: list[Body]) -> list[Touch]:
    """The contacts of equal balls."""
    touches = []
    for a, one in enumerate(bodies):
        for b in range(a + 1, len(bodies)):
            way = bodies[b].position - one.position
            distance = np.linalg.norm(way)
            if distance < 2 * radius * (1 + 1e-6):
                middle = (one.position + bodies[b].position) / 2
                touches.append(Touch(a, b, middle, way / distance))
    return touches


def rack(speed: float, offset: float, *, radius=0.028575, mass=0.17) -> Island:
    """A cue ball, ball 0, along x on a rack of fifteen that touch.

    Args:
        speed: Of the cue ball [m/s].
        offset: Of its centre from the axis of the rack, in diameters.
        radius: Of every ball [m].
        mass: Of every ball [kg].
    """
    d = 2 * radius
    cue = ball(
        mass, radius, [-d * np.sqrt(1 - offset**2), -d * offset, 0], [speed, 0, 0]
    )
    rows = [
        ball(mass, radius, [i * np.sqrt(3) * radius, (2 * j - i) * radius, 0])
        for i in range(5)
        for j in range(i + 1)
    ]
    bodies = [cue, *rows]
    return island(bodies, touching_balls(radius, bodies))
