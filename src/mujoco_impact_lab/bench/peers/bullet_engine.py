"""PyBullet: projected Gauss-Seidel on multibodies."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.methods import MethodFamily
from mujoco_impact_lab.bench.peers.common import SteppedEngine, stepped_family


class BulletRow(SteppedEngine):
    """A row of spheres on revolute joints."""

    _world: Any = None

    def restart(self) -> None:
        """Makes the world once, then puts the joints back."""
        if self._world is None:
            self._make()
        for ball, angle in zip(self._balls, self.start, strict=True):
            self._world.resetJointState(ball, 0, float(angle), 0.0)

    def step(self, count: int) -> None:
        """Makes some steps."""
        step = self._world.stepSimulation
        for _ in range(count):
            step()

    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Returns the states of the joints."""
        states = [self._world.getJointState(ball, 0) for ball in self._balls]
        return [state[0] for state in states], [state[1] for state in states]

    def __del__(self) -> None:
        """Closes the world: PyBullet has few connections."""
        if self._world is not None:
            self._world.disconnect()

    def _make(self) -> None:
        """Makes the world and hangs the balls into it."""
        with standard_output_to_error():
            import pybullet
            from pybullet_utils.bullet_client import BulletClient

            world = BulletClient(connection_mode=pybullet.DIRECT)
        self._world = world
        world.setGravity(0, 0, -self.chain.gravity)
        world.setPhysicsEngineParameter(
            fixedTimeStep=self.timestep,
            numSubSteps=0,
            numSolverIterations=200,
            restitutionVelocityThreshold=0.0,
            # no push against overlap, which would add energy
            erp=0.0,
            contactERP=0.0,
            contactSlop=0.0,
        )
        rows = zip(self.chain.masses, self.chain.radii, self.pivots, strict=True)
        self._balls = [self._hang(*values) for values in rows]

    def _hang(self, mass: float, radius: float, pivot: Array) -> int:
        """Adds one pendulum; returns its number."""
        world = self._world
        arm = [0, 0, -self.chain.length]
        sphere = world.createCollisionShape(
            world.GEOM_SPHERE, radius=radius, collisionFramePosition=arm
        )
        ball = world.createMultiBody(
            baseMass=0,
            basePosition=[float(pivot), 0, 0],
            linkMasses=[mass],
            linkCollisionShapeIndices=[sphere],
            linkVisualShapeIndices=[-1],
            linkPositions=[[0, 0, 0]],
            linkOrientations=[[0, 0, 0, 1]],
            linkInertialFramePositions=[arm],
            linkInertialFrameOrientations=[[0, 0, 0, 1]],
            linkParentIndices=[0],
            linkJointTypes=[world.JOINT_REVOLUTE],
            linkJointAxis=[[0, -1, 0]],
        )
        inertia = [0.4 * mass * radius**2] * 3
        world.changeDynamics(ball, 0, localInertiaDiagonal=inertia)
        # in a call of its own: with the inertia it would have no effect;
        # Bullet multiplies the restitutions of the two bodies
        world.changeDynamics(ball, 0, restitution=self.restitution**0.5)
        world.changeDynamics(
            ball,
            0,
            lateralFriction=0.0,
            rollingFriction=0.0,
            spinningFriction=0.0,
            jointDamping=0.0,
            activationState=world.ACTIVATION_STATE_DISABLE_SLEEPING,
        )
        # those of the whole multibody belong to its base
        world.changeDynamics(ball, -1, linearDamping=0.0, angularDamping=0.0)
        world.setJointMotorControl2(ball, 0, world.VELOCITY_CONTROL, force=0.0)
        return int(ball)


@contextlib.contextmanager
def standard_output_to_error() -> Iterator[None]:
    """Moves what the library prints when it is loaded out of the way of `--json -`."""
    sys.stdout.flush()
    saved = os.dup(1)
    try:
        os.dup2(2, 1)
        yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)


def family() -> MethodFamily:
    """Returns PyBullet as a method."""
    return stepped_family(
        "pybullet",
        "PyBullet, restitution 1",
        BulletRow,
        package="pybullet",
        setting="restitution e, threshold 0, erp 0, slop 0, 200 iterations",
        timesteps=(1 / 240, 2e-3, 1e-3, 2e-4),
        quick=2e-3,
    )
