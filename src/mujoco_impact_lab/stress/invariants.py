"""What must hold in every case of balls: one function per invariant, bound and reason.

A function returns how far an invariant is from holding, a number >= 0 that the bound is
for, or None where it says nothing about the case.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mujoco_impact import law
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.evidence import NUDGE, Evidence
from mujoco_impact_lab.stress.methods import OURS
from mujoco_impact_lab.stress.promises import FINITE, NO_PULL, SAME_BITS, Invariant
from mujoco_impact_lab.stress.record import Record

MOMENTUM = 1e-10
"""Change of momentum that is rounding, over the largest sum of mass times speed."""

GROWTH = 1e-9
"""Growth of energy that is rounding, over the kinetic energy at the start."""

SMALL = 1e-6
"""Part of the largest impulse from which on a pulse matters."""

PAIRS = 50_000
"""Pairs of balls, times steps, looked at together."""

CHAOS = 1e-2
"""A scene that makes more than this of a nudge of 1e-6, or of the error of a law that
is solved to 1e-7, is chaotic: symmetries are not judged by it."""

NUDGES = 20.0
"""Changes that a symmetry may make, over what the nudge makes: errors are smaller, but
enter in each of some tens of steps."""

SYMMETRIC = 1e-5
"""Change of velocities by a symmetry that needs no excuse, over the fastest speed."""

BENT = 0.1
"""Of the sum of radii: a path that an impact bends by more within a step is not known
between its ends."""


def momentum(evidence: Evidence) -> float | None:
    """Largest change of momentum of balls that only impacts act on."""
    if not evidence.case.is_free or not evidence.run.is_sound:
        return None
    return momentum_change(evidence.run)


def momentum_change(run: Record) -> float:
    """Returns the largest change of momentum, over the sum of mass times speed."""
    mass = run.balls.mass
    p = np.einsum("i,kij->kj", mass, run.velocity)
    speeds = np.linalg.norm(run.velocity, axis=2)
    return float(np.abs(p - p[0]).max() / (speeds @ mass).max())


def energy_growth(evidence: Evidence) -> float | None:
    """Largest growth of kinetic energy from before an impact to after it.

    A soft contact of MuJoCo may only store it: there every sample counts.
    """
    if not evidence.case.is_free or not evidence.run.is_sound:
        return None
    kinetic = kinetic_of(evidence.run)
    quiet = kinetic[evidence.run.quiet] if evidence.method == OURS else kinetic
    if len(quiet) < 2:
        return None
    return float(max(0.0, np.diff(quiet).max()) / kinetic[0])


def energy_drift(evidence: Evidence) -> float | None:
    """Drift of an elastic scene beyond that without contacts, per impact."""
    case, run = evidence.case, evidence.run
    if not (case.is_elastic and case.is_conservative and run.is_sound):
        return None
    if run.quiet.sum() < 2:
        return None
    kinetic_scale = max(kinetic_of(run).max(), 1e-300)
    drift = _drift(run, kinetic_scale)
    if not case.is_free:
        apart = evidence.apart
        drift -= _drift(apart, max(kinetic_of(apart).max(), 1e-300))
    return max(0.0, drift) / max(1, len(run.impacts) + run.missed)


def passing_through(evidence: Evidence) -> float | None:
    """Deepest overlap of two balls beyond that of the start, over the sum of radii.

    Measured on the straight lines between samples, so that a ball that is through
    within one step counts as passed through the middle. Where an impact in the step
    bends the path, only the ends of the step are known, and, on a rail, that balls
    keep their order: 1 if they do not.
    """
    run = evidence.run
    if not run.is_sound:
        return None
    first, second = np.triu_indices(len(run.balls.mass), 1)
    if len(first) == 0:
        return None
    touching = run.balls.radius[first] + run.balls.radius[second]
    collinear = evidence.case.joint == "rail"
    worst = 0.0
    begin = run.position[0, second] - run.position[0, first]
    start = np.maximum(0.0, 1 - np.linalg.norm(begin, axis=1) / touching)
    # in blocks of steps: many balls make many pairs
    block = max(1, PAIRS // len(first))
    for begin_at in range(0, len(run.position) - 1, block):
        steps = slice(begin_at, begin_at + block + 1)
        position = run.position[steps]
        between = position[:, second] - position[:, first]
        velocity = run.velocity[steps]
        change = np.diff(velocity[:, second] - velocity[:, first], axis=0)
        bend = np.linalg.norm(change, axis=2) * evidence.case.timestep
        nearest = np.where(
            bend > BENT * touching,
            np.linalg.norm(between[1:], axis=2),
            _nearest(between[:-1], between[1:]),
        )
        worst = max(worst, float((1 - nearest / touching - start).max()))
        if collinear and np.any(np.sign(between[:, :, 0]) != np.sign(begin[:, 0])):
            return 1.0
    return worst


def pulse_length(evidence: Evidence) -> float | None:
    """Longest pulse of the Hertz contact, over the longest that an impact may take.

    Only pulses that matter count. The longest is, per ball, one contact time of the two
    heaviest balls at the speed that the impulse gives one of them.
    """
    case, run = evidence.case, evidence.run
    if case.duration is not None or not run.impacts:
        return None
    radius, mass = run.balls.radius, run.balls.mass
    stiffness = law.hertz_stiffness(
        law.effective_modulus(case.young, 0.3), 2 / float(radius.min())
    )
    heaviest = float(mass.max())
    most = max(impact.impulse for impact in run.impacts)
    longest = 0.0
    for impact in run.impacts:
        # what is over within a step is delivered by its moment, however long it is
        if impact.impulse > SMALL * most and impact.duration > case.timestep:
            speed = impact.impulse / heaviest
            time = law.contact_time(stiffness, heaviest / 2, speed)
            longest = max(longest, impact.duration / time)
    return longest / case.count


def permutation(evidence: Evidence) -> float | None:
    """Change of velocities by another order of the bodies."""
    order = np.argsort(evidence.order)
    return _asymmetry(evidence, lambda case: case.permuted.velocity[:, order])


def mirroring(evidence: Evidence) -> float | None:
    """Change of velocities by mirroring there and back."""
    mirror = np.array([-1.0, 1.0, 1.0])
    if evidence.case.joint == "pendulum" or evidence.case.features:
        return None  # hinges and motors would have to be mirrored, too
    return _asymmetry(evidence, lambda case: case.mirrored.velocity * mirror)


INVARIANTS = (
    FINITE,
    Invariant(
        "momentum",
        "balls that only impacts act on keep their momentum",
        MOMENTUM,
        "rounding; in parts of the largest sum of mass times speed",
        momentum,
    ),
    Invariant(
        "energy growth",
        "no impact adds kinetic energy",
        GROWTH,
        "rounding; in parts of the kinetic energy at the start",
        energy_growth,
    ),
    Invariant(
        "elastic energy",
        "elastic scenes drift no more than without contacts, and 1e-6 per impact",
        1e-6,
        "the promise; in parts of the largest kinetic energy, per impact",
        energy_drift,
    ),
    NO_PULL,
    Invariant(
        "no passing",
        "no ball passes through another",
        0.75,
        "overlap over the sum of radii: 0.5 is the deepest that attach allows, 1 is "
        "centre through centre",
        passing_through,
    ),
    Invariant(
        "pulse length",
        "a Hertz pulse is over when the impact can be",
        10.0,
        "in contact times of the heaviest pair at the speed that its impulse gives, "
        "per ball; a contact may press a few times in one impact",
        pulse_length,
    ),
    SAME_BITS,
    Invariant(
        "permutation",
        "the order of the bodies does not matter",
        SYMMETRIC,
        "in parts of the fastest speed; where it is more, with the law at the "
        "tolerance 1e-8, and beyond 20 times what the scene makes of a change of 1e-6, "
        "or of the tolerance 1e-7",
        permutation,
        ours_only=True,
    ),
    Invariant(
        "mirror",
        "the mirror image does the mirror image",
        SYMMETRIC,
        "as for permutation",
        mirroring,
        ours_only=True,
    ),
)


def _asymmetry(
    evidence: Evidence, velocity_back: Callable[[Evidence], Array]
) -> float | None:
    """Returns the change by a symmetry beyond that by the nudge; None if chaotic.

    Args:
        evidence: The case.
        velocity_back: Returns the velocities of the image, put back where they were.
    """
    if not evidence.run.is_sound or "two instances" in evidence.case.features:
        return None
    change = _difference(evidence.run, velocity_back(evidence))
    # most scenes are that good; in the others it may be the error of the law
    if change <= SYMMETRIC:
        return change
    coarse, fine = evidence.fine
    change = _difference(fine.run, velocity_back(fine))
    if change <= SYMMETRIC:
        return change
    if not fine.nudged.is_sound or not coarse.run.is_sound:
        return None
    small = max(
        NUDGE,
        _difference(fine.run, fine.nudged.velocity),
        _difference(fine.run, coarse.run.velocity),
    )
    return None if small > CHAOS else max(0.0, change - NUDGES * small)


def _difference(run: Record, velocity: Array) -> float:
    """Returns the largest change of a velocity, over the fastest speed."""
    fastest = float(np.linalg.norm(run.velocity, axis=2).max())
    return float(np.abs(run.velocity - velocity).max()) / max(fastest, 1e-300)


def kinetic_of(run: Record) -> Array:
    """Returns the kinetic energy of the balls in each sample [J]."""
    speed2 = np.einsum("kij,kij->ki", run.velocity, run.velocity)
    result: Array = speed2 @ run.balls.mass / 2
    return result


def _drift(run: Record, scale: float) -> float:
    """Returns the largest change of energy between quiet samples, over a scale."""
    total = (kinetic_of(run) if run.energy is None else run.energy)[run.quiet]
    return float(np.abs(total - total[0]).max()) / scale if len(total) else 0.0


def _nearest(before: Array, after: Array) -> Array:
    """Returns the least length on the straight way between pairs of vectors."""
    way = after - before
    length2 = np.einsum("...j,...j", way, way)
    along = -np.einsum("...j,...j", before, way)
    part = np.clip(along / np.where(length2 > 0, length2, 1.0), 0.0, 1.0)
    nearest: Array = np.linalg.norm(before + part[..., None] * way, axis=-1)
    return nearest
