"""What of a model takes part in impacts: its balls and fixed bodies, and their pairs.

All in double precision, of the pose `qpos0`, and on the host. What the impacts on Warp
do not support is refused here, by name (support.py).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact.errors import SceneError
from mujoco_impact.law import hertz_stiffness
from mujoco_impact.pulses import geom_name, plugin_instances
from mujoco_impact.warp import support
from mujoco_impact.warp.settings import Settings, read_settings

Array = npt.NDArray[np.float64]

FREE, SLIDE, HINGE = (
    int(mujoco.mjtJoint.mjJNT_FREE),
    int(mujoco.mjtJoint.mjJNT_SLIDE),
    int(mujoco.mjtJoint.mjJNT_HINGE),
)
FIXED = -1
"""Kind of a body that nothing moves; else it is the type of its joint."""


@dataclass(frozen=True)
class Body:
    """A sphere on a body with one joint to the world, or a fixed sphere or plane.

    Attributes:
        geom: Number of the geom.
        kind: `FREE`, `SLIDE`, `HINGE` or `FIXED`.
        plane: Whether it is a plane.
        centre: Of the sphere, or a point of the plane [m], world frame.
        normal: Of the plane, world frame.
        radius: Of the sphere [m].
        joint: Number of the joint.
        axis: Of the joint, world frame.
        arm: From the anchor of the joint to the centre [m], world frame.
        lever: From the anchor to the centre of mass of all that the joint carries [m].
        mass: Of all that the joint carries [kg].
        inertia: M of the joint [kg or kg m²].
    """

    geom: int
    kind: int
    plane: bool
    centre: Array
    normal: Array
    radius: float
    joint: int = -1
    axis: Array = field(default_factory=lambda: np.zeros(3))
    arm: Array = field(default_factory=lambda: np.zeros(3))
    lever: Array = field(default_factory=lambda: np.zeros(3))
    mass: float = 0.0
    inertia: float = 1.0


@dataclass(frozen=True)
class Pair:
    """Two bodies that can meet; of a plane and a sphere the plane is the first.

    Attributes:
        first, second: Their numbers among the bodies; the normal points to the second.
        between: From centre to centre [m], or the normal of the plane, in `qpos0`.
        gap: Between the surfaces in `qpos0` [m].
        stiffness: K [N/m^1.5].
        depth: Overlap from which MuJoCo's solver has the contact [m].
        settings: Of the instance that owns the contact.
    """

    first: int
    second: int
    between: Array
    gap: float
    stiffness: float
    depth: float
    settings: Settings


@dataclass(frozen=True)
class Scene:
    """The bodies and pairs of a model."""

    bodies: tuple[Body, ...]
    pairs: tuple[Pair, ...]


def read_scene(model: mujoco.MjModel) -> Scene:
    """Returns the bodies and pairs whose impacts are ours.

    Raises:
        SceneError: If the model has no instance of the plugin, or something that is
            not supported on Warp.
    """
    if not isinstance(model, mujoco.MjModel):
        kind = type(model).__name__
        msg = f"model is of type {kind}; allowed: mujoco.MjModel, a compiled model"
        raise SceneError(msg)
    instances = plugin_instances(model)
    if not instances:
        msg = "the model has no instance of the plugin: mujoco_impact.attach adds one"
        raise SceneError(msg)
    support.check_options(model)
    owner = _owners(model, instances)
    settings = {instance: read_settings(model, instance) for instance in instances}
    meetings = [
        (one, two, _owner_of(owner, one, two))
        for one, two in support.meetings(model)
        if _owner_of(owner, one, two) is not None
    ]
    if not meetings:
        raise SceneError("no geom of the plugin can meet another geom")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    geoms = sorted({geom for one, two, _ in meetings for geom in (one, two)})
    bodies = tuple(_body(model, data, geom) for geom in geoms)
    support.check_bodies(model, [body.geom for body in bodies if body.kind != FIXED])
    number = {geom: i for i, geom in enumerate(geoms)}
    pairs = tuple(
        _pair(model, bodies, number[one], number[two], settings[instance])
        for one, two, instance in meetings
        if instance is not None
    )
    return Scene(bodies, pairs)


def fingerprint(model: mujoco.MjModel) -> str:
    """Returns what tells a model, with all its values, of every other."""
    content = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, content)
    return hashlib.sha256(content.tobytes()).hexdigest()


def _owners(model: mujoco.MjModel, instances: list[int]) -> dict[int, int]:
    """Returns the first instance that owns each geom (ownership.h)."""
    owner: dict[int, int] = {}
    for instance in instances:
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_PLUGIN, instance) or ""
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TUPLE, name)
        owned = np.arange(model.ngeom)
        if name and number >= 0:
            begin = int(model.tuple_adr[number])
            part = slice(begin, begin + int(model.tuple_size[number]))
            owned = model.tuple_objid[part][model.tuple_objprm[part] >= 0]
        for geom in owned.tolist():
            owner.setdefault(geom, instance)
    return owner


def _owner_of(owner: dict[int, int], one: int, two: int) -> int | None:
    """Returns the instance that owns the contact of two geoms."""
    return min((owner[geom] for geom in (one, two) if geom in owner), default=None)


def _body(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Body:
    """Returns the body of a geom that takes part."""
    support.check_shape(model, geom)
    plane = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE
    centre = data.geom_xpos[geom].copy()
    normal = data.geom_xmat[geom].reshape(3, 3)[:, 2].copy()
    radius = 0.0 if plane else float(model.geom_size[geom, 0])
    number = int(model.geom_bodyid[geom])
    if model.body_weldid[number] == 0:
        return Body(geom, FIXED, plane, centre, normal, radius)
    support.check_joint(model, geom)
    number = int(model.body_weldid[number])
    joint = int(model.body_jntadr[number])
    anchor = data.xanchor[joint]
    return Body(
        geom,
        int(model.jnt_type[joint]),
        plane,
        centre,
        normal,
        radius,
        joint,
        axis=data.xaxis[joint].copy(),
        arm=centre - anchor,
        lever=data.subtree_com[number] - anchor,
        mass=float(model.body_subtreemass[number]),
        inertia=float(model.dof_M0[model.jnt_dofadr[joint]]),
    )


def _pair(
    model: mujoco.MjModel,
    bodies: tuple[Body, ...],
    first: int,
    second: int,
    settings: Settings,
) -> Pair:
    """Returns the pair of two bodies."""
    if bodies[second].plane:
        first, second = second, first
    one, two = bodies[first], bodies[second]
    support.check_contact(model, one.geom, two.geom, settings)
    between = two.centre - one.centre
    if one.plane:
        gap = float(one.normal @ between) - two.radius
        between = one.normal
    else:
        gap = float(np.linalg.norm(between)) - one.radius - two.radius
    # 1/R* = 1/R₁ + 1/R₂
    curvature = sum(1 / body.radius for body in (one, two) if not body.plane)
    pair = Pair(
        first,
        second,
        between,
        gap,
        hertz_stiffness(settings.effective_modulus, curvature),
        -float(model.geom_margin[one.geom] + model.geom_margin[two.geom]),
        settings,
    )
    mass = min(body.mass for body in (one, two) if body.kind != FIXED)
    names = (geom_name(model, one.geom), geom_name(model, two.geom))
    support.check_duration(model, names, pair.stiffness, mass)
    return pair
