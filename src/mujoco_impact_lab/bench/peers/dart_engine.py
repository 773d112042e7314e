"""DART: a complementarity problem with Newton's restitution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mujoco_impact_lab.bench.methods import MethodFamily
from mujoco_impact_lab.bench.peers.common import SteppedEngine, stepped_family


class DartRow(SteppedEngine):
    """A row of spheres on revolute joints."""

    _world: Any = None

    def restart(self) -> None:
        """Makes the world anew."""
        import dartpy as dart

        world = dart.simulation.World()
        world.setGravity(np.array([0.0, 0.0, -self.chain.gravity]))
        world.setTimeStep(self.timestep)
        self._world = world
        self._joints = [self._hang(index) for index in range(self.chain.count)]

    def step(self, count: int) -> None:
        """Makes some steps."""
        step = self._world.step
        for _ in range(count):
            step()

    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Returns the states of the joints."""
        angles = [joint.getPosition(0) for joint in self._joints]
        return angles, [joint.getVelocity(0) for joint in self._joints]

    def _hang(self, index: int) -> Any:
        """Adds one pendulum; returns its joint."""
        import dartpy as dart

        mass, radius = self.chain.masses[index], self.chain.radii[index]
        skeleton = dart.dynamics.Skeleton(f"ball_{index}")
        joint, body = skeleton.createRevoluteJointAndBodyNodePair()
        joint.setAxis(np.array([0.0, -1.0, 0.0]))
        pivot = dart.math.Isometry3()
        pivot.set_translation(np.array([float(self.pivots[index]), 0.0, 0.0]))
        joint.setTransformFromParentBodyNode(pivot)
        arm = dart.math.Isometry3()
        arm.set_translation(np.array([0.0, 0.0, self.chain.length]))
        joint.setTransformFromChildBodyNode(arm)
        node = body.createShapeNode(dart.dynamics.SphereShape(radius))
        node.createCollisionAspect()
        aspect = node.createDynamicsAspect()
        # DART multiplies the restitutions of the two shapes
        aspect.setRestitutionCoeff(self.restitution**0.5)
        aspect.setFrictionCoeff(0.0)
        body.setInertia(
            dart.dynamics.Inertia(mass, np.zeros(3), np.eye(3) * 0.4 * mass * radius**2)
        )
        joint.setPosition(0, float(self.start[index]))
        self._world.addSkeleton(skeleton)
        return joint


def family() -> MethodFamily:
    """Returns DART as a method."""
    return stepped_family(
        "dart",
        "DART, restitution 1",
        DartRow,
        package="dartpy",
        setting="restitution e, no friction",
        timesteps=(5e-3, 2e-3, 1e-3, 2e-4),
        quick=2e-3,
    )
