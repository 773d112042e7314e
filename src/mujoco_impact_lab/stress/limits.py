"""Documented limits: what a case outside of them is counted as, instead of a violation.

Each limit is measured on the case, never assumed, and names the invariants that it
touches. docs/limits.md tells them to users.
"""

from __future__ import annotations

import itertools

import numpy as np

from mujoco_impact_lab.stress.evidence import Evidence
from mujoco_impact_lab.stress.invariants import (
    GROWTH,
    MOMENTUM,
    kinetic_of,
    momentum_change,
)
from mujoco_impact_lab.stress.methods import FASTEST, depth_of
from mujoco_impact_lab.stress.promises import Limit, first_limit
from mujoco_impact_lab.stress.scene import ARM

SLOW = 5e-7
"""Part of the closing speed that other forces may add while a pulse lasts, or in a
step: twice that is what they do to the energy."""

ALL_WORK = 0.69
"""Part of its budget that a step has left to the law; the rest is for its end."""

HARD = 0.3
"""Part of the closing speed by which other forces may change a speed within a step."""


def _diverges_alone(evidence: Evidence) -> bool:
    return bool(evidence.run.warnings) and bool(evidence.apart.warnings)


def _starts_deep(evidence: Evidence) -> bool:
    case, balls = evidence.case, evidence.run.balls
    first, second = np.triu_indices(case.count, 1)
    between = np.linalg.norm(balls.position[second] - balls.position[first], axis=1)
    overlap = balls.radius[first] + balls.radius[second] - between
    return float(overlap.max()) > 2 * depth_of(case, balls)


def _steady_change(evidence: Evidence) -> float:
    """Returns the largest change of a velocity in a step without an impact [m/s]."""
    run = evidence.run
    change = float(np.abs(np.diff(evidence.apart.velocity, axis=0)).max())
    steady = np.logical_and(run.quiet[:-1], run.quiet[1:])
    steady = np.logical_and(steady, np.logical_not(run.struck))
    if steady.any():
        # a light ball that was struck may be pulled harder
        struck = np.abs(np.diff(run.velocity, axis=0)[steady])
        change = max(change, float(struck.max()))
    return change


def _is_pulled(evidence: Evidence) -> bool:
    """Whether other forces matter while a pulse lasts, or in a step."""
    case = evidence.case
    if case.is_free or not evidence.run.impacts:
        return False
    longest = max(impact.duration for impact in evidence.run.impacts)
    time = max(longest, case.timestep)
    return _steady_change(evidence) / case.timestep * time > SLOW * case.speed


def _is_pulled_hard(evidence: Evidence) -> bool:
    """Whether other forces reverse speeds within a step."""
    case = evidence.case
    return not case.is_free and _steady_change(evidence) > HARD * case.speed


def _is_held(evidence: Evidence) -> bool:
    """Whether contacts of MuJoCo, which the law does not know, hold balls."""
    return evidence.run.native and not evidence.case.is_free


def _spins(evidence: Evidence) -> bool:
    """Whether a hinge turns by more than the path within a step can follow."""
    case = evidence.case
    if case.joint != "pendulum":
        return False
    return FASTEST * case.speed * case.timestep > ARM * case.radius


def _is_out_of_work(evidence: Evidence) -> bool:
    """Whether impacts took all that the law may take, as they are or reordered."""
    runs = [evidence.run, evidence.permuted]
    for fine in evidence.fine:
        runs += [fine.run, fine.permuted]
    return max(float(run.work.max()) for run in runs) >= ALL_WORK


def _is_pushed_out(evidence: Evidence) -> bool:
    """Whether energy grows only while MuJoCo's contacts push."""
    run = evidence.run
    kinetic = kinetic_of(run)
    quiet = np.flatnonzero(run.quiet)
    return run.native and not any(
        kinetic[end] - kinetic[begin] > GROWTH * kinetic[0]
        for begin, end in itertools.pairwise(quiet)
        if not run.pushed[begin:end].any()
    )


def _is_unsolved(evidence: Evidence) -> bool:
    """Whether momentum is kept where MuJoCo's solver goes on to rounding."""
    return evidence.run.native and momentum_change(evidence.solved) <= MOMENTUM


def _is_divided(evidence: Evidence) -> bool:
    return "two instances" in evidence.case.features


_ENERGY = frozenset({"energy growth", "elastic energy"})
_SYMMETRY = frozenset({"permutation", "mirror"})
_SHAPE = frozenset({"no passing"})

LIMITS = (
    Limit(
        "diverges without contacts",
        "MuJoCo cannot integrate the scene even if no ball meets another",
        frozenset({"finite"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _diverges_alone,
        ours_only=False,
    ),
    Limit(
        "starts deep",
        "balls overlap at the start by more than the depth M: contacts are MuJoCo's",
        frozenset({"momentum"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _starts_deep,
    ),
    Limit(
        "other forces",
        "gravity or springs change the closing speed by more than 5e-7 while a pulse "
        "lasts, or in a step: the law leaves them out",
        _ENERGY,
        _is_pulled,
    ),
    Limit(
        "hard pull",
        "forces other than impacts change a speed by more than 0.3 of the closing "
        "speed in one step: no contact can be foreseen",
        _SHAPE,
        _is_pulled_hard,
    ),
    Limit(
        "held",
        "other forces press balls together and MuJoCo's contact carries them: the law "
        "leaves that out",
        _ENERGY | _SHAPE,
        _is_held,
    ),
    Limit(
        "spins",
        "a hinge turns by more than a radian in a step",
        frozenset({"finite", "pulse length"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _spins,
    ),
    Limit(
        "out of work",
        "the impacts of a step take all the work that a step may, here or with another "
        "order or tolerance: they are ended at once",
        frozenset({"elastic energy"}) | _SYMMETRY,
        _is_out_of_work,
    ),
    Limit(
        "MuJoCo pushes",
        "MuJoCo's contacts push apart what a pulse longer than a step left overlapped: "
        "energy grows only then",
        frozenset({"energy growth"}),
        _is_pushed_out,
    ),
    Limit(
        "MuJoCo's solver",
        "MuJoCo's contacts push, and its solver stops at its tolerance: with "
        "tolerance 0 the momentum is kept",
        frozenset({"momentum"}),
        _is_unsolved,
    ),
    Limit(
        "divided",
        "balls that meet in one step belong to two instances: what one delivers is a "
        "steady force to the other",
        frozenset({"pulse length"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _is_divided,
    ),
)


def limit_of(evidence: Evidence, invariant: str) -> str:
    """Returns the name of the first limit that a case is outside of, "" if of none."""
    return first_limit(LIMITS, evidence, invariant)
