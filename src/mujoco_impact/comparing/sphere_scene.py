"""Bodies of a scene as spheres and planes of the Hertz problem in space."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.comparing.survey import Survey
from mujoco_impact.pulses import geom_name
from mujoco_impact.reference.spheres import Plane, Sphere
from mujoco_impact.trajectory import Array, Trajectory


class NoReference(Exception):
    """Why there is no reference."""


def spheres_of(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    bodies: tuple[int, ...],
    velocity: Array,
    free: Array,
) -> list[Sphere]:
    """Returns bodies as spheres of the Hertz problem.

    Args:
        model: The scene.
        data: The state just before the impact.
        bodies: Ids of the n bodies.
        velocity: Their velocities [m/s], shape (n, 3).
        free: Their acceleration without impacts [m/s²], shape (n, 3).

    Raises:
        NoReference: If one is no sphere, free or on slides.
    """
    found = []
    for number, body in enumerate(bodies):
        geom, joints = sphere_of(model, data, body), joints_of(model, body)
        slides = model.jnt_type[joints[0]] == mujoco.mjtJoint.mjJNT_SLIDE
        found.append(
            Sphere(
                mass=float(model.body_mass[body]),
                radius=float(model.geom_size[geom, 0]),
                position=data.geom_xpos[geom].copy(),
                velocity=velocity[number],
                acceleration=free[number],
                directions=data.xaxis[joints].copy() if slides else np.eye(3),
            )
        )
    return found


def sphere_of(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> int:
    """Returns the geom of a body that is a single sphere, free or on slides.

    Raises:
        NoReference: If it is another body.
    """
    geoms = _colliding(model, body)
    joints = joints_of(model, body)
    kinds = {int(model.jnt_type[joint]) for joint in joints}
    free = kinds == {int(mujoco.mjtJoint.mjJNT_FREE)}
    slides = kinds == {int(mujoco.mjtJoint.mjJNT_SLIDE)}
    whole = (
        len(geoms) == 1
        and model.geom_type[geoms[0]] == mujoco.mjtGeom.mjGEOM_SPHERE
        and model.body_parentid[body] == 0
        and np.allclose(data.xipos[body], data.geom_xpos[geoms[0]], atol=1e-9)
    )
    if not (whole and (free or slides)):
        msg = "several contacts of bodies other than free spheres act together"
        raise NoReference(msg)
    return geoms[0]


def plane_of(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Plane:
    """Returns a fixed geom as a plane of the Hertz problem."""
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE:
        name = geom_name(model, geom)
        raise NoReference(f"{name!r} is neither sphere nor plane")
    normal = data.geom_xmat[geom].reshape(3, 3)[:, 2].copy()
    return Plane(data.geom_xpos[geom].copy(), normal)


def lifted(sphere: Sphere, planes: list[Plane]) -> Sphere:
    """Returns a sphere that rests on a plane without sinking into it."""
    for plane in planes:
        gap = (sphere.position - plane.point) @ plane.normal - sphere.radius
        if gap < 0.0:
            lifted = sphere.position - gap * plane.normal
            sphere = dataclasses.replace(sphere, position=lifted)
    return sphere


def free_acceleration(
    model: mujoco.MjModel,
    motion: Trajectory,
    seen: Survey,
    before: int,
    bodies: tuple[int, ...],
) -> Array:
    """Returns the acceleration of bodies before an impact [m/s²], shape (n, 3)."""
    if before == 0:
        return np.tile(model.opt.gravity, (len(bodies), 1))
    step = float(motion.time[before] - motion.time[before - 1])
    change = seen.velocities[before, bodies] - seen.velocities[before - 1, bodies]
    acceleration: Array = change / step
    return acceleration


def _colliding(model: mujoco.MjModel, body: int) -> list[int]:
    """Returns the geoms of a body that can collide."""
    begin = int(model.body_geomadr[body])
    geoms = range(begin, begin + int(model.body_geomnum[body]))
    return [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]


def joints_of(model: mujoco.MjModel, body: int) -> list[int]:
    """Returns the joints of a body."""
    begin = int(model.body_jntadr[body])
    return list(range(begin, begin + int(model.body_jntnum[body])))
