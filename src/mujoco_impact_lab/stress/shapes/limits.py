"""Documented limits of cases of shapes, measured on the case."""

from __future__ import annotations

from functools import partial

import mujoco
import numpy as np

from mujoco_impact_lab.stress.promises import Limit
from mujoco_impact_lab.stress.shapes.evidence import Evidence
from mujoco_impact_lab.stress.shapes.invariants import GROWTH, axis_missed, kept_spin
from mujoco_impact_lab.stress.shapes.stretches import Stretch, stretches

SECOND_ORDER = 5.0
"""Growth of the energy over the square of the angle turned in a stretch."""

SMALL = 0.1
"""Largest angle of a stretch whose square tells anything [rad]."""

LEVER = 10.0
"""Change of spin that an arm explains, over the arm: (1 + e) m u a = 2/5 m r² ω, and as
much again for bodies that are not balls."""


def _diverges_alone(evidence: Evidence) -> bool:
    """Whether MuJoCo's own steps end a run: those of the scene, or those it came to."""
    if not evidence.run.warnings:
        return False
    if evidence.alone.warnings:
        return True
    # the energies of the last states of such a run may be anything
    with np.errstate(all="ignore"):
        sound = np.isfinite(evidence.energy.sum(axis=1))
        steps = np.flatnonzero(np.logical_and(sound[1:], sound[:-1]))
        free = float(evidence.integration[steps].sum())
        ours = float(np.abs(evidence.gained[steps]).sum())
        return free > ours and free > evidence.kinetic_at_start


def _is_integration(evidence: Evidence, *, native: bool) -> bool:
    """Whether the integrator itself changes energy as much, wherever it grows."""
    return all(
        stretch.growth <= stretch.integration
        for stretch in stretches(evidence)
        if stretch.native == native and stretch.growth > GROWTH
    )


def _is_second_order(evidence: Evidence) -> bool:
    """Whether energy grows by no more than what is left out of bent paths."""
    offending = [
        stretch
        for stretch in stretches(evidence)
        if not stretch.native
        and stretch.growth > max(GROWTH, stretch.integration)
        and (evidence.case.has_arms or stretch.last > stretch.first)
    ]
    return bool(offending) and all(
        stretch.growth <= SECOND_ORDER * min(SMALL, _turn(evidence, stretch)) ** 2
        for stretch in offending
    )


def _turn(evidence: Evidence, stretch: Stretch) -> float:
    """Returns a bound of the angle that a joint turns in a stretch [rad]."""
    model = evidence.scene.model
    velocities = evidence.run.qvel[stretch.first : stretch.last + 2]
    turning = [np.abs(velocities[:, _rotations(model, joint)]) for joint in
               range(model.njnt)]  # fmt: skip
    fastest = max((float(part.max()) for part in turning if part.size), default=0.0)
    return fastest * float(model.opt.timestep) * stretch.steps


def _rotations(model: mujoco.MjModel, joint: int) -> list[int]:
    """Returns the degrees of freedom of a joint that turn its body."""
    first = int(model.jnt_dofadr[joint])
    turning = {
        mujoco.mjtJoint.mjJNT_FREE: range(3, 6),
        mujoco.mjtJoint.mjJNT_BALL: range(3),
        mujoco.mjtJoint.mjJNT_HINGE: range(1),
    }
    kind = mujoco.mjtJoint(model.jnt_type[joint])
    return [first + dof for dof in turning.get(kind, range(0))]


def _misses_axis(evidence: Evidence) -> bool:
    """Whether MuJoCo's contacts of round bodies miss their axes by as much."""
    spin = kept_spin(evidence)
    return spin is not None and spin <= LEVER * axis_missed(evidence)


LIMITS = (
    Limit(
        "diverges without contacts",
        "MuJoCo cannot integrate the scene even if nothing meets, or its steps without "
        "the impacts add more energy than the scene had and than all impacts",
        frozenset({"finite"}),
        _diverges_alone,
        ours_only=False,
    ),
    Limit(
        "integrator",
        "MuJoCo's integrator changes the energy in the same steps without the impacts "
        "by as much as it grows",
        frozenset({"impact energy"}),
        partial(_is_integration, native=False),
    ),
    Limit(
        "integrator at rest",
        "the same while MuJoCo's contacts push: a body that rests does not lose what "
        "Euler's step takes from one that falls",
        frozenset({"contact energy"}),
        partial(_is_integration, native=True),
        ours_only=False,
    ),
    Limit(
        "bent arms",
        "a tree of several joints, whose inertia changes along the path that an impact "
        "bends, or a pulse longer than a step, which keeps its line while bodies turn; "
        "growth up to 5 times the square of the angle that a joint turns meanwhile, "
        "0.1 rad at most",
        frozenset({"impact energy"}),
        _is_second_order,
    ),
    Limit(
        "MuJoCo pushes",
        "MuJoCo's own contacts push bodies apart, as they do without the plugin",
        frozenset({"contact energy"}),
        lambda _evidence: True,
        ours_only=False,
    ),
    Limit(
        "narrow phase",
        "the line of action that MuJoCo's collision detection finds misses the axis of "
        "symmetry by a tenth of the change of spin, or more",
        frozenset({"spin"}),
        _misses_axis,
        ours_only=False,
    ),
)
