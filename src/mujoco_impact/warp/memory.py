"""The arrays on the device: tables of the scene, and what a step keeps of each world.

All in single precision. A figure of a body, a pair or a contact of a world stands at
[number, world], so that neighbouring threads read neighbouring numbers.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
import warp as wp

from mujoco_impact.warp.scene import FIXED, FREE, Scene


@wp.struct
class Bodies:
    """What does not change, by body; units as in `mujoco_impact.warp.scene.Body`."""

    kind: wp.array[int]
    qposadr: wp.array[int]
    dofadr: wp.array[int]
    zero: wp.array[wp.vec3]  # qpos0 of the joint: an angle, a length or a place
    axis: wp.array[wp.vec3]
    arm: wp.array[wp.vec3]
    lever: wp.array[wp.vec3]
    mass: wp.array[float]
    inertia: wp.array[float]
    damping: wp.array[float]
    stiffness: wp.array[float]
    radius: wp.array[float]
    of_geom: wp.array[int]  # number of the body by geom, −1: takes no part


@wp.struct
class Pairs:
    """What does not change, by pair; units as in `mujoco_impact.warp.scene.Pair`."""

    first: wp.array[int]
    second: wp.array[int]
    plane: wp.array[int]  # 1: the first is one
    between: wp.array[wp.vec3]
    gap: wp.array[float]
    stiffness: wp.array[float]
    depth: wp.array[float]
    restitution: wp.array[float]
    touch: wp.array[float]
    tolerance: wp.array[float]


@wp.struct
class Paths:
    """Where the bodies of each world go in the step, and what impacts did to them.

    The path is in the coordinates of the joint: the first component of a hinge or a
    slide, all three of a free body.
    """

    q: wp.array2d[wp.vec3]  # from qpos0, at the start of the step
    V: wp.array2d[wp.vec3]  # velocity of the path
    a: wp.array2d[wp.vec3]
    mobility: wp.array2d[float]  # 1/M
    G: wp.array2d[float]  # ∂a/∂q
    P: wp.array2d[wp.vec3]  # Σ M⁻¹Jᵀ P of the impulses of the step
    M1: wp.array2d[wp.vec3]  # Σ M⁻¹Jᵀ P s, s their times
    M2: wp.array2d[wp.vec3]  # Σ M⁻¹Jᵀ P s²
    busy: wp.array2d[float]  # until when an impact has the body [s]
    round: wp.array2d[int]  # the last round that struck it


@wp.struct
class Contacts:
    """The contacts of an impact of each world, and the state of the law."""

    pair: wp.array2d[int]
    J1: wp.array2d[wp.vec3]  # row of the first body in coordinates of its joint
    J2: wp.array2d[wp.vec3]
    W: wp.array3d[float]  # Delassus matrix [1/kg]
    K: wp.array2d[float]
    e: wp.array2d[float]
    gap: wp.array2d[float]
    closing: wp.array2d[float]  # closing speed when the impact begins [m/s]
    pressing: wp.array2d[float]  # rate of the closing speed by other forces [m/s²]
    y: wp.array2d[float]
    c: wp.array2d[float]
    rate: wp.array2d[float]  # dy/dt over c: 1, or 1/e² while expanding
    y_new: wp.array2d[float]
    c_new: wp.array2d[float]
    F1: wp.array2d[float]
    F2: wp.array2d[float]
    F3: wp.array2d[float]
    F4: wp.array2d[float]
    G1: wp.array2d[float]  # W F of the stages
    G2: wp.array2d[float]
    G3: wp.array2d[float]
    G4: wp.array2d[float]
    P: wp.array2d[float]
    M: wp.array2d[float]
    onset: wp.array2d[float]


@wp.struct
class World:
    """What is kept of each world beside that."""

    closing_time: wp.array2d[float]  # of each pair; NEVER if it does not close [s]
    member: wp.array2d[int]  # the last round that each pair took part in
    qpos: wp.array2d[float]  # at the start of the step
    qvel: wp.array2d[float]
    flag: wp.array[int]
    impacts: wp.array[int]
    law_steps: wp.array[int]


def put_bodies(model: Any, scene: Scene, device: Any) -> Any:
    """Returns `Bodies` on a device."""
    joints = [body.joint for body in scene.bodies]
    moving = [body.kind != FIXED for body in scene.bodies]
    dofs = [int(model.jnt_dofadr[j]) if j >= 0 else 0 for j in joints]
    places = [int(model.jnt_qposadr[j]) if j >= 0 else 0 for j in joints]
    zero = np.zeros((len(joints), 3))
    for i, body in enumerate(scene.bodies):
        if moving[i]:
            width = 3 if body.kind == FREE else 1
            zero[i, :width] = model.qpos0[places[i] : places[i] + width]
    springs = not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_SPRING
    of_geom = np.full(model.ngeom, -1)
    of_geom[[body.geom for body in scene.bodies]] = np.arange(len(joints))
    columns: dict[str, Any] = {
        "kind": [body.kind for body in scene.bodies],
        "qposadr": places,
        "dofadr": dofs,
        "zero": zero,
        "axis": [body.axis for body in scene.bodies],
        "arm": [body.arm for body in scene.bodies],
        "lever": [body.lever for body in scene.bodies],
        "mass": [body.mass for body in scene.bodies],
        "inertia": [body.inertia for body in scene.bodies],
        "damping": np.where(moving, model.dof_damping[dofs], 0.0),
        "stiffness": np.where(moving, model.jnt_stiffness[joints], 0.0) * springs,
        "radius": [body.radius for body in scene.bodies],
        "of_geom": of_geom,
    }
    return _fill(Bodies, columns, device)


def put_pairs(scene: Scene, device: Any) -> Any:
    """Returns `Pairs` on a device."""
    columns: dict[str, Any] = {
        "first": [pair.first for pair in scene.pairs],
        "second": [pair.second for pair in scene.pairs],
        "plane": [scene.bodies[pair.first].plane for pair in scene.pairs],
        "between": [pair.between for pair in scene.pairs],
        "gap": [pair.gap for pair in scene.pairs],
        "stiffness": [pair.stiffness for pair in scene.pairs],
        "depth": [pair.depth for pair in scene.pairs],
        "restitution": [pair.settings.restitution for pair in scene.pairs],
        "touch": [pair.settings.touch for pair in scene.pairs],
        "tolerance": [pair.settings.tolerance for pair in scene.pairs],
    }
    return _fill(Pairs, columns, device)


def make(struct: Any, rows: int, nworld: int, device: Any) -> Any:
    """Returns zeros for a struct of `Paths` or `Contacts`, `rows` for each world."""
    made = struct()
    for name, variable in struct.vars.items():
        kind = variable.type
        shape = (rows, nworld) if kind.ndim == 2 else (rows, rows, nworld)
        setattr(made, name, wp.zeros(shape, dtype=kind.dtype, device=device))
    return made


def make_world(
    pairs: int, positions: int, velocities: int, nworld: int, device: Any
) -> Any:
    """Returns `World`, all zero."""
    world = World()
    world.closing_time = wp.zeros((pairs, nworld), dtype=float, device=device)
    world.member = wp.zeros((pairs, nworld), dtype=int, device=device)
    world.qpos = wp.zeros((nworld, positions), dtype=float, device=device)
    world.qvel = wp.zeros((nworld, velocities), dtype=float, device=device)
    for name in ("flag", "impacts", "law_steps"):
        setattr(world, name, wp.zeros(nworld, dtype=int, device=device))
    return world


def size_in_bytes(**structs: Any) -> int:
    """Returns the size of all arrays of structs, by the names of their kinds."""
    arrays = [
        getattr(struct, name)
        for kind, struct in structs.items()
        for name in globals()[kind].vars
    ]
    return sum(int(array.capacity) for array in arrays)


def _fill(struct: Any, columns: dict[str, Any], device: Any) -> Any:
    """Returns a struct with these arrays."""
    made = struct()
    for name, column in columns.items():
        kind = struct.vars[name].type
        whole = kind.dtype in (int, wp.int32)
        array: npt.NDArray[Any] = np.asarray(column, np.int32 if whole else np.float32)
        setattr(made, name, wp.array(array, dtype=kind.dtype, device=device))
    return made
