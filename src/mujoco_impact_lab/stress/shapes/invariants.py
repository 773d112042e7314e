"""What must hold in every case of shapes: one function per invariant.

The functions return what `Invariant.value` asks for. MuJoCo's own contacts, where they
push, are judged by themselves: a step of theirs is none of the impacts.
"""

from __future__ import annotations

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.promises import FINITE, NO_PULL, SAME_BITS, Invariant
from mujoco_impact_lab.stress.shapes.evidence import Evidence
from mujoco_impact_lab.stress.shapes.stretches import stretches
from mujoco_impact_lab.stress.shapes.work import BUDGET, counted_work

GROWTH = 1e-6
"""Energy that an impact may add, over the largest kinetic energy."""

CENTRED = 1e-9
"""Distance of a centre of mass from its joint that counts as none, over the size."""


def impact_energy(evidence: Evidence) -> float | None:
    """Largest energy that impacts of the plugin have added at any time."""
    return _growth(evidence, native=False)


def contact_energy(evidence: Evidence) -> float | None:
    """The same while MuJoCo's own contacts push."""
    return _growth(evidence, native=True)


def below_floor(evidence: Evidence) -> float | None:
    """How deep a geom is in the floor, over half of its width: 1 is its centre."""
    if not evidence.run.is_sound or evidence.height is None:
        return None
    return max(0.0, 1 - float(np.nanmin(evidence.height)))


def momentum(evidence: Evidence) -> float | None:
    """Largest change of momentum of bodies that only impacts act on.

    Of free bodies with the centre of mass in the joint: the integrator itself does not
    keep that of others.
    """
    case, run = evidence.case, evidence.run
    if case.gravity or evidence.scene.floor is not None or not run.is_sound:
        return None
    bodies = _free_bodies(evidence)
    if len(bodies) < len(case.trees):
        return None
    model = evidence.scene.apart
    velocity = np.stack([run.qvel[:, _dof(model, b) :][:, :3] for b in bodies], axis=1)
    mass = model.body_mass[bodies]
    total = np.einsum("i,kij->kj", mass, velocity)
    scale = float((np.linalg.norm(velocity, axis=2) @ mass).max())
    return float(np.abs(total - total[0]).max()) / max(scale, 1e-300)


def kept_spin(evidence: Evidence) -> float | None:
    """Largest change of a spin about an axis of symmetry in a step by its contacts.

    Over the fastest turn, or speed over half-width. Of contacts without friction: those
    of dimension 1.
    """
    run, model = evidence.run, evidence.scene.apart
    if evidence.case.condim > 1 or not run.is_sound:
        return None
    worst: float | None = None
    for body in _free_bodies(evidence):
        axes = _axes_of_symmetry(model, body)
        if axes is None:
            continue
        dof = _dof(model, body)
        turn, speed = run.qvel[:, dof + 3 : dof + 6], run.qvel[:, dof : dof + 3]
        scale = np.linalg.norm(turn, axis=1).max()
        scale += np.linalg.norm(speed, axis=1).max() / evidence.case.size
        change = (turn[1:] - evidence.apart[1][:, dof + 3 : dof + 6]) @ axes.T
        largest = float(np.abs(change).max()) / max(scale, 1e-300)
        worst = max(worst or 0.0, largest)
    return worst


def restitution(evidence: Evidence) -> float | None:
    """Largest error of the energy that an impact of one contact takes in a step.

    Over the largest kinetic energy, and beyond what the integrator makes of the step,
    where that is less than the bound.
    Of contacts without friction, those of dimension 1, without gravity, which works
    while a pulse lasts, and without arms. A contact that closes with u and delivers the
    impulse P takes (1 − e) P u / 2, with the e of the contact.
    """
    case, run = evidence.case, evidence.run
    if case.condim > 1 or case.gravity or case.has_arms or not run.is_sound:
        return None
    errors = []
    for stretch in stretches(evidence):
        step = stretch.first
        if stretch.native or stretch.steps > 1 or step not in evidence.single:
            continue
        if stretch.integration > GROWTH:
            continue
        impact = evidence.single[step]
        lost = (1 - impact.restitution) * impact.impulse * impact.closing_speed / 2
        error = abs(evidence.gained[step] + lost) / evidence.kinetic
        errors.append(max(0.0, error - stretch.integration))
    return max(errors, default=None)


def axis_missed(evidence: Evidence) -> float:
    """Returns by how much lines of contact miss axes of symmetry, over the size.

    As MuJoCo finds the contacts in the samples of the run, the largest.
    """
    model, run = evidence.scene.model, evidence.run
    data = mujoco.MjData(model)
    worst = 0.0
    for sample in np.flatnonzero(run.struck | run.pushed):
        data.qpos[:] = run.qpos[sample]
        mujoco.mj_fwdPosition(model, data)
        for body in _free_bodies(evidence):
            axes = _axes_of_symmetry(model, body)
            if axes is None:
                continue
            for contact in data.contact:
                if body in model.geom_bodyid[contact.geom]:
                    arm = np.cross(contact.pos - data.xipos[body], contact.frame[:3])
                    along = axes @ data.xmat[body].reshape(3, 3).T @ arm
                    worst = max(worst, float(np.abs(along).max()))
    return worst / evidence.case.size


def _growth(evidence: Evidence, *, native: bool) -> float | None:
    """Returns the largest growth of the stretches with or without MuJoCo's contacts."""
    if not evidence.run.is_sound:
        return None
    found = [s.growth for s in stretches(evidence) if s.native == native]
    return max(0.0, *found) if found else None


def _free_bodies(evidence: Evidence) -> list[int]:
    """Returns the single bodies on a free joint whose centre of mass is in it."""
    case, model = evidence.case, evidence.scene.apart
    free = [
        int(model.body(f"body{tree.number}_0").id)
        for tree in case.trees
        if tree.joint == "free"
    ]
    centred = CENTRED * case.size
    return [body for body in free if np.abs(model.body_ipos[body]).max() < centred]


def _dof(model: mujoco.MjModel, body: int) -> int:
    """Returns the first degree of freedom of a body."""
    return int(model.body_dofadr[body])


def _axes_of_symmetry(model: mujoco.MjModel, body: int) -> Array | None:
    """Returns the axes about which no contact of a body without friction turns it.

    In the frame of the body, shape (n, 3); None if there are none.
    """
    if model.body_geomnum[body] != 1:
        return None
    geom = int(model.body_geomadr[body])
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return np.eye(3)
    round_ = kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER)
    if not round_ and (kind != mujoco.mjtGeom.mjGEOM_ELLIPSOID or size[0] != size[1]):
        return None
    axis = np.zeros(3)
    mujoco.mju_rotVecQuat(axis, np.array([0.0, 0.0, 1.0]), model.geom_quat[geom])
    return axis[None]


INVARIANTS = (
    FINITE,
    Invariant(
        "impact energy",
        "impacts add no energy to what the same steps have without them",
        GROWTH,
        "the promise; since nothing acted last, in parts of the largest kinetic energy",
        impact_energy,
        ours_only=True,
    ),
    Invariant(
        "contact energy",
        "the same while MuJoCo's own contacts push",
        GROWTH,
        "as for impact energy",
        contact_energy,
    ),
    Invariant(
        "floor",
        "no centre of a geom gets below the floor",
        1.0,
        "depth in half-widths: 1 is the centre, 0.5 the deepest that attach allows",
        below_floor,
    ),
    Invariant(
        "momentum",
        "bodies that only impacts act on keep their momentum",
        1e-10,
        "rounding; in parts of the largest sum of mass times speed",
        momentum,
    ),
    Invariant(
        "spin",
        "an impact does not turn a body about its axis of symmetry",
        1e-9,
        "rounding; in parts of the fastest turn, or speed over half-width",
        kept_spin,
    ),
    Invariant(
        "restitution",
        "an impact of one contact without friction takes what its e says",
        GROWTH,
        "as for impact energy, beyond what the integrator makes of the step",
        restitution,
        ours_only=True,
    ),
    NO_PULL,
    Invariant(
        "work",
        "no step costs more than its budget",
        BUDGET,
        "counted by the plugin, where it counts",
        counted_work,
        ours_only=True,
    ),
    SAME_BITS,
)
