"""Recognising a row of pendulum balls, the scene that has a Hertz reference."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact.reference import Chain
from mujoco_impact.trajectory import Array

GEOMETRY_TOLERANCE = 1e-9
"""How exactly a scene must be a row: lengths in arm lengths, inertia in its own size.

A row written by hand meets it; what deviates more is another scene, and comparing it
with the reference would charge the difference to the contacts.
"""


@dataclasses.dataclass(frozen=True, eq=False)
class PendulumRow:
    """A row of balls on rigid massless arms, as found in a model.

    Attributes:
        chain: Masses, radii, gaps and arm length of the row.
        dofs: Number of the hinge of each ball, in the order of the row, shape (n,).
        signs: +1 where a positive hinge angle moves the ball along the row, -1 where
            it moves it back, shape (n,).
    """

    chain: Chain
    dofs: npt.NDArray[np.intp]
    signs: Array

    def angles(self, coordinates: Array) -> Array:
        """Converts qpos or qvel, shape (..., nv), to angles of the row [rad, rad/s]."""
        result: Array = coordinates[..., self.dofs] * self.signs
        return result


def find_row(
    model: mujoco.MjModel, *, young: float = 2e11, poisson: float = 0.3
) -> PendulumRow | None:
    """Returns the row of pendulums that a model is, or None if it is another scene.

    A row is: every joint an unlimited hinge without spring, damping, armature or
    friction; all hinges parallel, horizontal and at one height; on each one
    sphere that hangs straight down at angle 0, all at the same distance; no
    other body that moves and nothing else to collide with.

    Args:
        model: The model.
        young: Young's modulus of the balls [Pa].
        poisson: Poisson's ratio of the balls.
    """
    gravity = float(np.linalg.norm(model.opt.gravity))
    if not (_has_plain_hinges(model) and gravity > 0):
        return None
    spheres = _hanging_spheres(model)
    if spheres is None:
        return None
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    down = model.opt.gravity / gravity
    arms = data.geom_xpos[spheres] - data.xanchor
    lengths = np.linalg.norm(arms, axis=1)
    length = float(lengths[0])
    slack = GEOMETRY_TOLERANCE * length
    centres = data.geom_xpos[spheres]
    offsets = centres - centres[0]
    axes = data.xaxis
    straight = (
        np.abs(arms - length * down).max() < slack
        and np.abs(np.cross(axes, axes[0])).max() < GEOMETRY_TOLERANCE
        and np.abs(axes @ down).max() < GEOMETRY_TOLERANCE
        and np.abs(offsets @ down).max() < slack
        and np.abs(offsets @ axes[0]).max() < slack
    )
    if not straight:
        return None
    along = np.cross(axes[0], down)
    order = np.argsort(offsets @ along)
    masses = model.body_mass[model.geom_bodyid[spheres]]
    radii = model.geom_size[spheres, 0]
    inertias = masses * (length**2 + 0.4 * radii**2)
    # the mass matrix is diagonal here: one hinge per body
    if np.abs(model.dof_M0 / inertias - 1.0).max() > GEOMETRY_TOLERANCE:
        return None
    distances = np.diff((offsets @ along)[order])
    chain = Chain(
        masses=tuple(masses[order].tolist()),
        radii=tuple(radii[order].tolist()),
        gaps=tuple((distances - radii[order][:-1] - radii[order][1:]).tolist()),
        length=length,
        young=young,
        poisson=poisson,
        gravity=gravity,
    )
    signs = np.sign(np.cross(axes, arms) @ along)
    return PendulumRow(chain, order, signs[order])


def _has_plain_hinges(model: mujoco.MjModel) -> bool:
    """Returns whether the model moves by free hinges only, each from angle 0."""
    only_hinges = (
        model.nv > 0
        and model.nv == model.njnt
        and bool(np.all(model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE))
    )
    forces = (
        model.jnt_stiffness,
        model.dof_damping,
        model.dof_armature,
        model.dof_frictionloss,
        model.jnt_limited,
        model.qpos0,
    )
    return (
        only_hinges
        and not any(np.any(force) for force in forces)
        and model.neq == model.ntendon == model.nu == 0
        and model.opt.density == model.opt.viscosity == 0
    )


def _hanging_spheres(model: mujoco.MjModel) -> npt.NDArray[np.intp] | None:
    """Returns the sphere on each hinge, shape (nv,); None if it is not one each."""
    able = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    colliding = np.flatnonzero(able)
    bodies = model.geom_bodyid[colliding]
    one_each = (
        len(colliding) == model.nv
        and bool(np.all(model.geom_type[colliding] == mujoco.mjtGeom.mjGEOM_SPHERE))
        and bool(np.all(model.body_dofnum[bodies] == 1))
        and len(np.unique(bodies)) == model.nv
        and bool(np.all(model.body_parentid[bodies] == 0))
    )
    if not one_each:
        return None
    spheres = np.empty(model.nv, dtype=np.intp)
    spheres[model.body_dofadr[bodies]] = colliding
    return spheres
