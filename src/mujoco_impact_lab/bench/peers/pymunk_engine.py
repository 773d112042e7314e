"""Pymunk (Chipmunk): sequential impulses in the plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from mujoco_impact_lab.bench.methods import MethodFamily
from mujoco_impact_lab.bench.peers.common import SteppedEngine, stepped_family


class PymunkRow(SteppedEngine):
    """A row of circles on pivot joints."""

    # Chipmunk moves the bodies before it changes their velocities
    shift = -1.0

    def restart(self) -> None:
        """Makes a new space."""
        import pymunk

        space = pymunk.Space()
        space.gravity = (0.0, -self.chain.gravity)
        # no slop and no push against overlap, which would add energy
        space.collision_slop = 0.0
        space.collision_bias = 1.0
        space.damping = 1.0
        self._space: Any = space
        self._balls = [self._hang(index) for index in range(self.chain.count)]

    def step(self, count: int) -> None:
        """Makes some steps."""
        step, timestep = self._space.step, self.timestep
        for _ in range(count):
            step(timestep)

    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Returns the angles and rates about the pivots."""
        angles, rates = list[float](), list[float]()
        for ball, pivot in zip(self._balls, self.pivots, strict=True):
            x, y = ball.position.x - pivot, ball.position.y
            vx, vy = ball.velocity
            angles.append(math.atan2(x, -y))
            rates.append((x * vy - y * vx) / (x * x + y * y))
        return angles, rates

    def _hang(self, index: int) -> Any:
        """Adds one pendulum."""
        import pymunk

        mass, radius = self.chain.masses[index], self.chain.radii[index]
        pivot, angle = float(self.pivots[index]), float(self.start[index])
        length = self.chain.length
        ball = pymunk.Body(mass, 0.4 * mass * radius**2)
        ball.position = (
            pivot + length * math.sin(angle),
            -length * math.cos(angle),
        )
        circle = pymunk.Circle(ball, radius)
        # Chipmunk multiplies the elasticities of the two shapes
        circle.elasticity = math.sqrt(self.restitution)
        circle.friction = 0.0
        joint = pymunk.PivotJoint(self._space.static_body, ball, (pivot, 0.0))
        joint.collide_bodies = False
        self._space.add(ball, circle, joint)
        return ball


def family() -> MethodFamily:
    """Returns Pymunk as a method."""
    return stepped_family(
        "pymunk",
        "Pymunk, elasticity 1",
        PymunkRow,
        package="pymunk",
        setting="elasticity e, no slop, no bias, 10 iterations",
        timesteps=(1 / 60, 5e-3, 2e-3, 5e-4, 2e-4),
        quick=2e-3,
    )
