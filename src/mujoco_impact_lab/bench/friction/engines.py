"""Other engines with friction, on the same scenes: PyBullet, DART, and Pymunk.

Each makes its world of the shapes, masses and states of the compiled scene. Pymunk
knows the plane, and so the break and the dominoes. Exudyn's contacts of spheres, as the
rows have them, have no friction.
"""

from __future__ import annotations

import abc
import math
import time
from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.friction.methods import Setting
from mujoco_impact_lab.bench.friction.scene import FrictionScene, Motion
from mujoco_impact_lab.bench.peers.bullet_engine import standard_output_to_error
from mujoco_impact_lab.bench.peers.common import installed

GROUND = 5.0
"""Half-size of the ground, where it is a box [m]."""


class Engine(abc.ABC):
    """A scene in an engine that is stepped from Python."""

    def __init__(self, scene: FrictionScene, timestep: float) -> None:
        """Prepares a scene.

        Args:
            scene: The scene.
            timestep: Timestep [s].
        """
        self.scene = scene
        self.timestep = timestep
        self.steps = round(scene.duration / timestep)
        model = scene.spec().compile()
        self.gravity = -float(model.opt.gravity[2])
        fixed = model.geom_bodyid == 0
        self.has_floor = bool(fixed.any())
        self.shapes = [
            (int(kind), size.copy(), float(model.body_mass[body]))
            for kind, size, body in zip(
                model.geom_type[~fixed],
                model.geom_size[~fixed],
                model.geom_bodyid[~fixed],
                strict=True,
            )
        ]

    @abc.abstractmethod
    def restart(self, qpos: Array, qvel: Array) -> None:
        """Makes a world and puts the bodies to a start, rows of 7 and 6 numbers.

        Spins are in the frame of the world.
        """

    @abc.abstractmethod
    def step(self) -> Callable[[], object]:
        """Returns what makes one step."""

    @abc.abstractmethod
    def state(self) -> tuple[Array, Array]:
        """Returns rows of 7 and 6 numbers, as `restart` takes them."""

    def record(self) -> list[Motion]:
        """Runs once from every start, with a sample every step."""
        return [self._motion(*start) for start in self.scene.starts]

    def run_time(self) -> float:
        """Runs once from every start; making the world is not counted."""
        spent = 0.0
        for start in self.scene.starts:
            self.restart(*_of_the_world(*start))
            step = self.step()
            begin = time.process_time()
            for _ in range(self.steps):
                step()
            spent += time.process_time() - begin
        return spent

    def _motion(self, qpos: Array, qvel: Array) -> Motion:
        self.restart(*_of_the_world(qpos, qvel))
        step, states = self.step(), [self.state()]
        for _ in range(self.steps):
            step()
            states.append(self.state())
        times = np.arange(self.steps + 1, dtype=np.float64) * self.timestep
        places, speeds = (np.array(rows) for rows in zip(*states, strict=True))
        turns = Rotation.from_quat(places[..., 3:].reshape(-1, 4), scalar_first=True)
        spins = turns.inv().apply(speeds[..., 3:].reshape(-1, 3))
        speeds[..., 3:] = spins.reshape(speeds[..., 3:].shape)
        flat = len(times), -1
        return Motion(times, places.reshape(flat), speeds.reshape(flat))


def _of_the_world(qpos: Array, qvel: Array) -> tuple[Array, Array]:
    """Returns rows of 7 and 6 numbers of MuJoCo's state, spins turned to the world."""
    places, speeds = qpos.reshape(-1, 7).copy(), qvel.reshape(-1, 6).copy()
    turns = Rotation.from_quat(places[:, 3:], scalar_first=True)
    speeds[:, 3:] = turns.apply(speeds[:, 3:])
    return places, speeds


class Bullet(Engine):
    """Projected Gauss-Seidel."""

    _world: Any = None

    def restart(self, qpos: Array, qvel: Array) -> None:
        """Makes the world once, then puts the bodies back."""
        if self._world is None:
            self._make()
        world = self._world
        for body, place, speed in zip(self._bodies, qpos, qvel, strict=True):
            turn = np.roll(place[3:], -1)
            world.resetBasePositionAndOrientation(body, place[:3], turn)
            world.resetBaseVelocity(body, speed[:3], speed[3:])

    def step(self) -> Callable[[], object]:
        """Returns Bullet's step."""
        return self._world.stepSimulation  # type: ignore[no-any-return]

    def state(self) -> tuple[Array, Array]:
        """Returns the states of the bodies."""
        places, speeds = list[list[float]](), list[list[float]]()
        for body in self._bodies:
            place, (x, y, z, w) = self._world.getBasePositionAndOrientation(body)
            velocity, spin = self._world.getBaseVelocity(body)
            places.append([*place, w, x, y, z])
            speeds.append([*velocity, *spin])
        return np.array(places), np.array(speeds)

    def __del__(self) -> None:
        """Closes the world: PyBullet has few connections."""
        if self._world is not None:
            self._world.disconnect()

    def _make(self) -> None:
        with standard_output_to_error():
            import pybullet
            from pybullet_utils.bullet_client import BulletClient

            world = BulletClient(connection_mode=pybullet.DIRECT)
        self._world = world
        world.setGravity(0, 0, -self.gravity)
        world.setPhysicsEngineParameter(
            fixedTimeStep=self.timestep,
            numSubSteps=0,
            numSolverIterations=200,
            restitutionVelocityThreshold=0.0,
        )
        if self.gravity == 0:
            # no push against overlap, which would add energy
            world.setPhysicsEngineParameter(erp=0.0, contactERP=0.0, contactSlop=0.0)
        if self.has_floor:
            plane = world.createCollisionShape(world.GEOM_PLANE)
            self._set(world.createMultiBody(0, plane))
        self._bodies = [self._add(*shape) for shape in self.shapes]

    def _add(self, kind: int, size: Array, mass: float) -> int:
        """Adds a body; returns its number."""
        world = self._world
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            shape = world.createCollisionShape(world.GEOM_SPHERE, radius=size[0])
        else:
            shape = world.createCollisionShape(world.GEOM_BOX, halfExtents=size)
        body = int(world.createMultiBody(mass, shape))
        self._set(body)
        return body

    def _set(self, body: int) -> None:
        """Sets what touches; Bullet multiplies the values of the two bodies."""
        self._world.changeDynamics(
            body,
            -1,
            restitution=self.scene.restitution**0.5,
            lateralFriction=self.scene.friction**0.5,
            rollingFriction=0.0,
            spinningFriction=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            activationState=self._world.ACTIVATION_STATE_DISABLE_SLEEPING,
        )


class Dart(Engine):
    """A complementarity problem with Newton's restitution."""

    def restart(self, qpos: Array, qvel: Array) -> None:
        """Makes the world anew."""
        import dartpy as dart

        self._dart: Any = dart
        self._world: Any = dart.simulation.World()
        self._world.setGravity(np.array([0.0, 0.0, -self.gravity]))
        self._world.setTimeStep(self.timestep)
        if self.has_floor:
            self._ground()
        rows = zip(self.shapes, qpos, qvel, strict=True)
        self._bodies = [self._add(*shape, q, v) for shape, q, v in rows]

    def step(self) -> Callable[[], object]:
        """Returns DART's step."""
        return self._world.step  # type: ignore[no-any-return]

    def state(self) -> tuple[Array, Array]:
        """Returns the states of the bodies."""
        places, speeds = list[Array](), list[Array]()
        for body in self._bodies:
            pose = body.getWorldTransform()
            turn = Rotation.from_matrix(pose.rotation())
            quaternion = turn.as_quat(scalar_first=True)
            places.append(np.concatenate([pose.translation(), quaternion]))
            spin, velocity = body.getAngularVelocity(), body.getLinearVelocity()
            speeds.append(np.concatenate([velocity, spin]))
        return np.array(places), np.array(speeds)

    def _ground(self) -> None:
        """Adds a box whose top is the floor."""
        dart = self._dart
        skeleton = dart.dynamics.Skeleton("floor")
        joint, body = skeleton.createWeldJointAndBodyNodePair()
        size = np.array([2 * GROUND, 2 * GROUND, 2.0])
        self._touches(body, dart.dynamics.BoxShape(size))
        pose = dart.math.Isometry3()
        pose.set_translation(np.array([0.0, 0.0, -1.0]))
        joint.setTransformFromParentBodyNode(pose)
        self._world.addSkeleton(skeleton)

    def _add(
        self, kind: int, size: Array, mass: float, place: Array, speed: Array
    ) -> Any:
        """Adds a body and returns it."""
        dart = self._dart
        skeleton = dart.dynamics.Skeleton(f"body {self._world.getNumSkeletons()}")
        joint, body = skeleton.createFreeJointAndBodyNodePair()
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            shape = dart.dynamics.SphereShape(size[0])
            inertia = np.eye(3) * 0.4 * mass * size[0] ** 2
        else:
            shape = dart.dynamics.BoxShape(2 * size)
            inertia = np.diag(mass / 3 * (size @ size - size**2))
        self._touches(body, shape)
        body.setInertia(dart.dynamics.Inertia(mass, np.zeros(3), inertia))
        pose = dart.math.Isometry3()
        turn = Rotation.from_quat(place[3:], scalar_first=True)
        pose.set_rotation(turn.as_matrix())
        pose.set_translation(place[:3])
        joint.setTransform(pose)
        # in the frame of the world
        joint.setLinearVelocity(speed[:3])
        joint.setAngularVelocity(speed[3:])
        self._world.addSkeleton(skeleton)
        return body

    def _touches(self, body: Any, shape: Any) -> None:
        """Sets what touches.

        DART multiplies the restitutions of two shapes, and takes the lower friction.
        """
        node = body.createShapeNode(shape)
        node.createCollisionAspect()
        aspect = node.createDynamicsAspect()
        aspect.setRestitutionCoeff(self.scene.restitution**0.5)
        aspect.setFrictionCoeff(self.scene.friction)


class Pymunk(Engine):
    """Sequential impulses in the plane (Chipmunk)."""

    def restart(self, qpos: Array, qvel: Array) -> None:
        """Makes a new space."""
        import pymunk

        assert self.scene.plane is not None
        space = pymunk.Space()
        space.gravity = (0.0, -self.gravity)
        space.damping = 1.0
        if self.gravity == 0:
            # no slop and no push against overlap, which would add energy
            space.collision_slop, space.collision_bias = 0.0, 1.0
        else:
            # slop: 0.1 in units of a pixel, as it comes
            space.collision_slop = 1e-5
        self._space: Any = space
        if self.has_floor:
            ends = (-GROUND, 0.0), (GROUND, 0.0)
            floor = pymunk.Segment(space.static_body, *ends, 0.0)
            self._touches(floor)
            space.add(floor)
        rows = zip(self.shapes, qpos, qvel, strict=True)
        self._bodies = [self._add(*shape, q, v) for shape, q, v in rows]

    def step(self) -> Callable[[], object]:
        """Returns Pymunk's step."""
        step, timestep = self._space.step, self.timestep
        return lambda: step(timestep)

    def state(self) -> tuple[Array, Array]:
        """Returns the states of the bodies, at rest across the plane."""
        plane, across = self._axes()
        places = np.zeros((len(self._bodies), 7))
        speeds = np.zeros((len(self._bodies), 6))
        for place, speed, body in zip(places, speeds, self._bodies, strict=True):
            place[plane], speed[plane] = body.position, body.velocity
            half = body.angle / 2
            place[3], place[4:] = math.cos(half), math.sin(half) * across
            speed[3:] = body.angular_velocity * across
        return places, speeds

    def _axes(self) -> tuple[list[int], Array]:
        """Returns the axes of the plane, and about which it turns counterclockwise."""
        assert self.scene.plane is not None
        first, second = self.scene.plane
        axes = np.eye(3)
        return [first, second], np.cross(axes[first], axes[second])

    def _add(
        self, kind: int, size: Array, mass: float, place: Array, speed: Array
    ) -> Any:
        """Adds a body and returns it."""
        import pymunk

        plane, across = self._axes()
        half = size[plane]
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            body = pymunk.Body(mass, 0.4 * mass * size[0] ** 2)
            shape: Any = pymunk.Circle(body, size[0])
        else:
            body = pymunk.Body(mass, float(mass / 3 * half @ half))
            shape = pymunk.Poly.create_box(body, tuple(2 * half))
        body.position = tuple(place[plane])
        body.angle = 2 * math.atan2(place[4:] @ across, place[3])
        body.velocity = tuple(speed[plane])
        body.angular_velocity = float(speed[3:] @ across)
        self._touches(shape)
        self._space.add(body, shape)
        return body

    def _touches(self, shape: Any) -> None:
        """Sets what touches; Chipmunk multiplies the values of the two shapes."""
        shape.elasticity = self.scene.restitution**0.5
        shape.friction = self.scene.friction**0.5


ENGINES: dict[str, tuple[str, type[Engine], str, Sequence[float], str]] = {
    "pymunk": (
        "pymunk", Pymunk, "Pymunk", (5e-3, 2e-3, 5e-4, 2e-4), "10 iterations",
    ),
    "pybullet": (
        "pybullet", Bullet, "PyBullet", (1 / 240, 2e-3, 1e-3, 2e-4),
        "threshold 0, 200 iterations",
    ),
    "dart": ("dartpy", Dart, "DART", (5e-3, 2e-3, 1e-3, 2e-4), "e and mu"),
}  # fmt: skip
"""Distribution, engine, title, timesteps [s] and setting of each method."""


def obstacle(name: str, scene: FrictionScene) -> str:
    """Returns why an engine cannot have a scene, else empty."""
    package, engine, *_ = ENGINES[name]
    if installed(package) is None:
        return f"not installed ({package}; scripts/bench)"
    if engine is Pymunk and scene.plane is None:
        return "knows the plane only"
    return ""


def engine_settings(name: str) -> list[Setting]:
    """Returns an engine at its timesteps."""
    _, engine, _, timesteps, words = ENGINES[name]

    def setting(timestep: float) -> Setting:
        return Setting(
            name,
            words,
            timestep,
            "semi-implicit",
            lambda scene: engine(scene, timestep),
            quick=timestep == 2e-3,
        )

    return list(map(setting, timesteps))
