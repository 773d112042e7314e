"""What impacts on Warp support; everything else is refused by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.law import contact_time
from mujoco_impact.pulses import geom_name
from mujoco_impact.warp.settings import Settings

SLOW = 1e-3
"""Closing speed at which a contact must be over within a step [m/s]."""

_INTEGRATORS = {
    int(integrator): integrator.name.removeprefix("mjINT_").lower()
    for integrator in (
        mujoco.mjtIntegrator.mjINT_EULER,
        mujoco.mjtIntegrator.mjINT_IMPLICIT,
        mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    )
}


def check_options(model: mujoco.MjModel) -> None:
    """Raises SceneError if an option of the model is not supported."""
    if int(model.opt.integrator) not in _INTEGRATORS:
        name = mujoco.mjtIntegrator(model.opt.integrator).name.removeprefix("mjINT_")
        raise _refusal(
            f"the integrator {name.lower()}",
            f"allowed: {', '.join(_INTEGRATORS.values())}",
        )
    if model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP:
        raise _refusal("the flag sleep")
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT:
        raise _refusal("the disabled flag contact", "without contacts nothing meets")


def meetings(model: mujoco.MjModel) -> Iterator[tuple[int, int]]:
    """Yields the pairs of geoms whose contacts MuJoCo leaves out by negative margins.

    Raises:
        SceneError: If such a contact is of an explicit pair.
    """
    excluded = {int(signature) for signature in model.exclude_signature}
    body = model.geom_bodyid
    weld = model.body_weldid[body]
    for one in range(model.ngeom):
        for two in range(one + 1, model.ngeom):
            if weld[one] == weld[two]:
                continue
            if model.geom_margin[one] + model.geom_margin[two] >= 0:
                continue
            low, high = sorted((int(body[one]), int(body[two])))
            if (low << 16) + high in excluded or _is_parent(model, low, high):
                continue
            if (
                model.geom_contype[one] & model.geom_conaffinity[two]
                or model.geom_contype[two] & model.geom_conaffinity[one]
            ):
                yield one, two
    for one, two in zip(model.pair_geom1, model.pair_geom2, strict=True):
        if model.geom_margin[one] < 0 or model.geom_margin[two] < 0:
            raise _refusal(f"the explicit contact pair of {_names(model, one, two)}")


def check_shape(model: mujoco.MjModel, geom: int) -> None:
    """Raises SceneError unless a geom is a sphere or a fixed plane."""
    kind = mujoco.mjtGeom(model.geom_type[geom])
    body = int(model.geom_bodyid[geom])
    moves = model.body_weldid[body] != 0
    allowed = "allowed: spheres, and fixed planes"
    if kind == mujoco.mjtGeom.mjGEOM_PLANE and not moves:
        pass
    elif kind != mujoco.mjtGeom.mjGEOM_SPHERE:
        what = kind.name.removeprefix("mjGEOM_").lower()
        raise _refusal(f"the {what} {geom_name(model, geom)!r}", allowed)
    if model.body_mocapid[model.body_rootid[body]] >= 0:
        raise _refusal(
            f"the mocap body of the geom {geom_name(model, geom)!r}", allowed
        )


def check_joint(model: mujoco.MjModel, geom: int) -> None:
    """Raises SceneError unless the body of a geom has one joint to the world."""
    name = geom_name(model, geom)
    allowed = "allowed: one joint to the world, hinge, slide or free"
    body = int(model.body_weldid[model.geom_bodyid[geom]])
    tree = np.flatnonzero(model.body_rootid == model.body_rootid[body])
    parent = int(model.body_parentid[body])
    chain = model.body_weldid[parent] != 0 or model.body_jntnum[tree].sum() != 1
    if chain:
        raise _refusal(f"the chain of joints of the geom {name!r}", allowed)
    joint = int(model.body_jntadr[body])
    kind = mujoco.mjtJoint(model.jnt_type[joint])
    if kind == mujoco.mjtJoint.mjJNT_BALL:
        raise _refusal(f"the ball joint of the geom {name!r}", allowed)
    if kind == mujoco.mjtJoint.mjJNT_FREE:
        offsets = (model.geom_pos[geom], model.body_ipos[body])
        if model.geom_bodyid[geom] != body or np.any(np.abs(offsets) > 1e-9):
            raise _refusal(
                f"the free body of the geom {name!r}",
                "allowed: a sphere whose centre is that of the body and of its mass",
            )
    dof = int(model.jnt_dofadr[joint])
    features = {
        "a limit": model.jnt_limited[joint],
        "dry friction": model.dof_frictionloss[dof] > 0,
        "nonlinear damping": np.any(model.dof_dampingpoly[dof]),
        "a nonlinear spring": np.any(model.jnt_stiffnesspoly[joint]),
        "gravity compensation": np.any(model.body_gravcomp[tree]),
    }
    for what, is_so in features.items():
        if is_so:
            raise _refusal(f"{what} on the joint of the geom {name!r}")


def check_bodies(model: mujoco.MjModel, geoms: Sequence[int]) -> None:
    """Raises SceneError if moving geoms share a body, or are tied to something."""
    body = {int(model.body_weldid[model.geom_bodyid[geom]]): geom for geom in geoms}
    if len(body) < len(geoms):
        raise _refusal("two geoms of one body", "allowed: one sphere a body")
    for tied, what in _ties(model):
        geom = body.get(int(model.body_weldid[tied]))
        if geom is not None:
            raise _refusal(
                f"the {what} on the body of the geom {geom_name(model, geom)!r}"
            )


def check_contact(
    model: mujoco.MjModel, one: int, two: int, settings: Settings
) -> None:
    """Raises SceneError if a contact has friction."""
    both = [one, two]
    priority = model.geom_priority[both]
    deciding = [
        geom for geom, p in zip(both, priority, strict=True) if p == priority.max()
    ]
    # condim and friction are the larger of the two
    dimensions = int(model.geom_condim[deciding].max())
    friction = float(model.geom_friction[deciding, 0].max())
    if dimensions > 1 and friction > 0 and not settings.frictionless:
        raise _refusal(
            f"the friction of {_names(model, one, two)}",
            "give them condim 1, or attach with friction='none'",
        )


def check_duration(
    model: mujoco.MjModel, names: tuple[str, str], stiffness: float, mass: float
) -> None:
    """Raises SceneError if a slow contact outlasts a step."""
    time = contact_time(stiffness, mass, SLOW)
    if time > model.opt.timestep:
        raise _refusal(
            f"pulses that last: a contact of {names[0]!r} and {names[1]!r} takes "
            f"{time:.2g} s at {SLOW:g} m/s, longer than the timestep",
            "raise young or the timestep",
        )


def _ties(model: mujoco.MjModel) -> Iterator[tuple[int, str]]:
    """Yields bodies that an equality constraint or a tendon holds, and by what."""
    for number in range(model.neq):
        name = _named(model, mujoco.mjtObj.mjOBJ_EQUALITY, number)
        kind = mujoco.mjtEq(model.eq_type[number])
        for element in (int(model.eq_obj1id[number]), int(model.eq_obj2id[number])):
            if element < 0:
                continue
            if kind == mujoco.mjtEq.mjEQ_JOINT:
                yield int(model.jnt_bodyid[element]), f"equality constraint {name}"
            elif model.eq_objtype[number] == mujoco.mjtObj.mjOBJ_SITE:
                yield int(model.site_bodyid[element]), f"equality constraint {name}"
            elif model.eq_objtype[number] == mujoco.mjtObj.mjOBJ_BODY:
                yield element, f"equality constraint {name}"
    of_element = {
        int(mujoco.mjtWrap.mjWRAP_JOINT): model.jnt_bodyid,
        int(mujoco.mjtWrap.mjWRAP_SITE): model.site_bodyid,
        int(mujoco.mjtWrap.mjWRAP_SPHERE): model.geom_bodyid,
        int(mujoco.mjtWrap.mjWRAP_CYLINDER): model.geom_bodyid,
    }
    for number in range(model.ntendon):
        name = _named(model, mujoco.mjtObj.mjOBJ_TENDON, number)
        begin = int(model.tendon_adr[number])
        for wrap in range(begin, begin + int(model.tendon_num[number])):
            bodies = of_element.get(int(model.wrap_type[wrap]))
            if bodies is not None:
                yield int(bodies[model.wrap_objid[wrap]]), f"tendon {name}"


def _is_parent(model: mujoco.MjModel, one: int, two: int) -> bool:
    """Returns whether MuJoCo leaves the contacts of two bodies out as of a parent."""
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
        return False
    welds = [int(model.body_weldid[body]) for body in (one, two)]
    parents = [int(model.body_weldid[model.body_parentid[weld]]) for weld in welds]
    return 0 not in welds and (welds[0] == parents[1] or welds[1] == parents[0])


def _named(model: mujoco.MjModel, kind: mujoco.mjtObj, number: int) -> str:
    """Returns the name of an element, or its number."""
    name = mujoco.mj_id2name(model, kind, number)
    return repr(name) if name else str(number)


def _names(model: mujoco.MjModel, one: int, two: int) -> str:
    """Returns the names of two geoms."""
    return f"{geom_name(model, int(one))!r} and {geom_name(model, int(two))!r}"


def _refusal(what: str, allowed: str = "") -> SceneError:
    """Returns the error that names what is not supported."""
    return SceneError(
        f"mujoco_impact.warp does not support {what}{': ' if allowed else ''}{allowed}"
    )
