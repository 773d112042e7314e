"""The scene of a case of shapes: its models, and the velocity that it starts with."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.scene import attach
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.methods import OURS
from mujoco_impact_lab.stress.shapes.bodies import Built, direction, tree_of
from mujoco_impact_lab.stress.shapes.case import Case
from mujoco_impact_lab.stress.shapes.floor import Floor, floor_mjcf, floor_of
from mujoco_impact_lab.stress.shapes.materials import Materials, materials_of

AIM = 0.15
"""How far off the mark trees go, over their speed."""


@dataclasses.dataclass(frozen=True, eq=False)
class Scene:
    """A case, ready to run.

    Attributes:
        spec: With the impacts of the method; its keyframe "start" is the start.
        model: The same, compiled.
        apart: Without any contact, and without the plugin; its states are the same.
        qvel: Velocity at the start, shape (nv,).
        floor: None in free space.
        materials: Of the geoms.
    """

    spec: mujoco.MjSpec
    model: mujoco.MjModel
    apart: mujoco.MjModel
    qvel: Array
    floor: Floor | None
    materials: Materials


def scene_of(case: Case, method: str = OURS, *, renamed: bool = False) -> Scene:
    """Returns the scene of a case under one of `METHODS`.

    Args:
        case: The case.
        method: The method.
        renamed: Whether its materials have each other's names.
    """
    trees = [tree_of(case, tree) for tree in case.trees]
    places = _places(case, trees)
    centres = np.vstack([t.centres + p for t, p in zip(trees, places, strict=True)])
    floor = floor_of(case, centres, np.concatenate([tree.reaches for tree in trees]))
    plain = mujoco.MjSpec.from_string(_mjcf(case, trees, places, floor))
    materials = materials_of(case, [g.name for g in plain.geoms], renamed=renamed)
    # speeds are over what our contacts see, whatever the method
    spec = attach(plain, restitution=case.restitution, **vars(materials))
    model = spec.compile()
    qvel = _velocity(case, model, places, floor)
    if method != OURS:
        spec, model = plain, plain.compile()
    spec.add_key(name="start", qvel=qvel)
    apart = plain.compile()
    apart.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return Scene(spec, model, apart, qvel, floor, materials)


def _places(case: Case, trees: list[Built]) -> list[Array]:
    """Returns where the roots are [m]: each tree as near to the first as it can be."""
    places: list[Array] = [np.zeros(3)]
    for tree, built in zip(case.trees[1:], trees[1:], strict=True):
        way = direction(np.random.default_rng((case.seed, 3, tree.number)))
        distance = 0.0
        for other, place in zip(trees, places, strict=False):
            between = (built.centres[:, None] - (other.centres + place)).reshape(-1, 3)
            reach = (built.reaches[:, None] + other.reaches).ravel()
            reach += case.clearance * case.size
            # |b + s w| = r has its larger root at s = −b·w + √((b·w)² − b² + r²)
            along = between @ way
            inside = along**2 - np.einsum("ij,ij->i", between, between) + reach**2
            meets = inside > 0
            roots = np.sqrt(inside[meets]) - along[meets]
            distance = max(distance, float(roots.max(initial=0.0)))
        places.append(distance * way)
    return places


def _mjcf(
    case: Case, trees: list[Built], places: list[Array], floor: Floor | None
) -> str:
    """Returns the scene as MJCF, with MuJoCo's own contacts."""
    ground, assets = floor_mjcf(floor)
    assets += "".join(tree.assets for tree in trees)
    bodies = "\n    ".join(
        tree.body.format(pos=" ".join(repr(float(x)) for x in place))
        for tree, place in zip(trees, places, strict=True)
    )
    return f"""
<mujoco model="shapes {case.seed}">
  <option timestep="{case.timestep!r}" gravity="0 0 {-case.gravity!r}"
          integrator="{case.integrator}" cone="{case.cone}"
          jacobian="{case.jacobian}"/>
  <default><geom condim="{case.condim}"/></default>
  <asset>{assets}</asset>
  <worldbody>
    {ground}
    {bodies}
  </worldbody>
</mujoco>"""


def _velocity(
    case: Case, model: mujoco.MjModel, places: list[Array], floor: Floor | None
) -> Array:
    """Returns the velocity at the start, shape (nv,): trees go for each other or down.

    The fastest point goes `pace` times the gap in a step.
    """
    qvel = np.zeros(model.nv)
    for tree, place in zip(case.trees, places, strict=True):
        random = np.random.default_rng((case.seed, 4, tree.number))
        towards = np.mean(places, axis=0) - place
        if floor is not None and random.random() < 0.7:
            towards = -floor.normal
        length = float(np.linalg.norm(towards))
        towards = (towards / length if length > 0 else 0.0) + AIM * direction(random)
        for link in range(tree.links):
            body = model.body(f"body{tree.number}_{link}")
            first, count = int(body.jntadr[0]), int(body.jntnum[0])
            for joint in range(first, first + count):
                _start_joint(case, model, joint, towards, random, qvel)
    fastest = _fastest(model, qvel)
    sight = float((model.geom_gap + model.geom_margin)[_moving(model)].min())
    return qvel * (case.pace * sight / case.timestep / max(fastest, 1e-300))


def _start_joint(
    case: Case,
    model: mujoco.MjModel,
    joint: int,
    towards: Array,
    random: np.random.Generator,
    qvel: Array,
) -> None:
    """Gives a joint a velocity of the order of 1 m/s."""
    dof = model.jnt_dofadr[joint]
    turn = random.normal(size=3) / case.size
    match model.jnt_type[joint]:
        case mujoco.mjtJoint.mjJNT_FREE:
            qvel[dof : dof + 3] = towards
            qvel[dof + 3 : dof + 6] = case.spin * turn
        case mujoco.mjtJoint.mjJNT_BALL:
            qvel[dof : dof + 3] = turn
        case mujoco.mjtJoint.mjJNT_SLIDE:
            qvel[dof] = model.jnt_axis[joint] @ towards
        case mujoco.mjtJoint.mjJNT_HINGE:
            qvel[dof] = turn[0]


def _fastest(model: mujoco.MjModel, qvel: Array) -> float:
    """Returns a bound of the speed of all points of the geoms that move [m/s]."""
    data = mujoco.MjData(model)
    data.qvel[:] = qvel
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    speeds = [0.0]
    for geom in _moving(model):
        velocity = np.zeros(6)
        mujoco.mj_objectVelocity(
            model, data, mujoco.mjtObj.mjOBJ_GEOM, geom, velocity, 0
        )
        turning = np.linalg.norm(velocity[:3]) * model.geom_rbound[geom]
        speeds.append(float(turning + np.linalg.norm(velocity[3:])))
    return max(speeds)


def _moving(model: mujoco.MjModel) -> list[int]:
    """Returns the geoms of the bodies that can move."""
    return [int(geom) for geom in np.flatnonzero(model.geom_bodyid != 0)]
