"""Documented limits: what a case outside of them is counted as, instead of a violation.

Each limit is measured on the case, never assumed, and names the invariants that it
touches. README.md ("Limits") and plugin/README.md tell them to users.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from mujoco_impact.stress.evidence import Evidence
from mujoco_impact.stress.invariants import energy_growth
from mujoco_impact.stress.methods import FASTEST, OURS, depth_of
from mujoco_impact.stress.scene import ARM

DEEP = 0.3
"""Way in a pulse, over the smallest radius, from which balls no longer meet as the law
sees them: they press into each other, or pass each other, by their own size."""

TURNING = 0.2
"""Energy that a pulse may add, in parts of that at the start, over that way."""

SLOW = 1e-4
"""Part of the closing speed that other forces may add while a pulse lasts, or in a
step."""


AMPLIFIED, MOST_ACCELERATION = 100.0, 1e10
"""Speed of the lightest ball behind heavier ones, over that of the first impact; and
mjMAXVAL, from which on MuJoCo resets a state [m/s^2, rad/s^2]."""

RATTLING, LIGHT = 0.7, 5.0
"""Restitution below which, and mass ratio above which, a light ball between two heavy
ones rattles for many contact times before they all go together."""


@dataclasses.dataclass(frozen=True)
class Limit:
    """One documented limit.

    Attributes:
        name: Short, for tables.
        meaning: In words.
        invariants: Names of the invariants that it touches.
        holds: Whether a case is outside of it.
    """

    name: str
    meaning: str
    invariants: frozenset[str]
    holds: Callable[[Evidence], bool]


def way_in_pulse(evidence: Evidence) -> float:
    """Returns the way of the fastest ball in the longest pulse, over a radius."""
    run = evidence.run
    if not run.impacts:
        return 0.0
    longest = max(impact.duration for impact in run.impacts)
    fastest = float(np.linalg.norm(run.velocity, axis=2).max())
    return longest * fastest / float(run.balls.radius.min())


def outlasts_a_step(evidence: Evidence) -> bool:
    """Whether any pulse is delivered in more than one step."""
    case = evidence.case
    return case.duration is not None or any(
        impact.duration > case.timestep for impact in evidence.run.impacts
    )


def _diverges_alone(evidence: Evidence) -> bool:
    return bool(evidence.run.warnings) and bool(evidence.apart.warnings)


def _presses_deep(evidence: Evidence) -> bool:
    return way_in_pulse(evidence) > DEEP


def _starts_deep(evidence: Evidence) -> bool:
    case, balls = evidence.case, evidence.run.balls
    first, second = np.triu_indices(case.count, 1)
    between = np.linalg.norm(balls.position[second] - balls.position[first], axis=1)
    overlap = balls.radius[first] + balls.radius[second] - between
    return float(overlap.max()) > 2 * depth_of(case, balls)


def _is_handed_over(evidence: Evidence) -> bool:
    """Whether MuJoCo's contacts took part because balls overlap deeper than owned."""
    case, run = evidence.case, evidence.run
    if not run.native:
        return False
    way = way_in_pulse(evidence) * float(run.balls.radius.min())
    if case.integrator == "RK4":
        # positions in the middle of a step are not part of the motion
        fastest = float(np.linalg.norm(run.velocity, axis=2).max())
        way += fastest * case.timestep / 2
    return way / np.pi > 2 * depth_of(case, run.balls)


def _turns(evidence: Evidence) -> bool:
    """Whether pulses turn with balls that slide past each other, and by little."""
    case = evidence.case
    collinear = case.joint in ("rail", "pendulum")
    if collinear or not outlasts_a_step(evidence):
        return False
    growth = energy_growth(evidence)
    return growth is None or growth <= TURNING * way_in_pulse(evidence)


def _is_pulled(evidence: Evidence) -> bool:
    """Whether other forces matter while a pulse lasts, or in a step."""
    case = evidence.case
    if case.is_free or not evidence.run.impacts:
        return False
    change = np.abs(np.diff(evidence.apart.velocity, axis=0)).max()
    run = evidence.run
    steady = run.quiet[:-1] & run.quiet[1:]
    for impact in run.impacts:
        step = int(impact.time / case.timestep)
        steady[max(0, step - 1) : step + 2] = False
    if steady.any():
        # a light ball that was struck may be pulled harder
        change = max(change, np.abs(np.diff(run.velocity, axis=0)[steady]).max())
    longest = max(impact.duration for impact in run.impacts)
    time = max(longest, case.timestep)
    return bool(change / case.timestep * time > SLOW * case.speed)


def _runs_out_of_slots(evidence: Evidence) -> bool:
    return evidence.run.missed > 0


def _rattles(evidence: Evidence) -> bool:
    """Whether light balls may rattle between heavy ones until they all go together."""
    case = evidence.case
    mass = evidence.run.balls.mass
    return (
        case.count > 2
        and case.restitution < RATTLING
        and float(mass.max() / mass.min()) > LIGHT
    )


def _spins(evidence: Evidence) -> bool:
    """Whether a hinge turns by more than the path within a step can follow."""
    case = evidence.case
    if case.joint != "pendulum":
        return False
    return FASTEST * case.speed * case.timestep > ARM * case.radius


def _exceeds_numbers(evidence: Evidence) -> bool:
    """Whether a blow to a light ball may exceed what MuJoCo takes for a sane state."""
    case = evidence.case
    arm = ARM * case.radius if case.joint == "pendulum" else 1.0
    return AMPLIFIED * case.speed / case.timestep / arm > MOST_ACCELERATION


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
    ),
    Limit(
        "starts deep",
        "balls overlap at the start by more than the depth M: contacts are MuJoCo's",
        frozenset({"momentum"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _starts_deep,
    ),
    Limit(
        "presses deep",
        "balls travel more than 0.3 radii while a pulse lasts: too soft or too fast "
        "for a Hertz contact, or a fixed duration too long",
        frozenset({"finite", "momentum"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _presses_deep,
    ),
    Limit(
        "handed over",
        "balls overlap by more than the depth M while a pulse lasts, and MuJoCo's "
        "contact takes over",
        frozenset({"momentum"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _is_handed_over,
    ),
    Limit(
        "turning pulse",
        "a pulse longer than a step turns with balls that slide past each other, and "
        "adds no more than 0.2 of the way they go in it over a radius",
        _ENERGY,
        _turns,
    ),
    Limit(
        "other forces",
        "gravity or springs change the closing speed by more than 1e-4 while a pulse "
        "lasts, or in a step: the law leaves them out",
        _ENERGY,
        _is_pulled,
    ),
    Limit(
        "rattling",
        "a light ball with losses between heavy ones (e < 0.7, masses 1:5 and more) "
        "bounces until all go together, for up to 100 contact times and more",
        frozenset({"pulse length"}) | _SYMMETRY,
        _rattles,
    ),
    Limit(
        "spins",
        "a hinge turns by more than a radian in a step",
        frozenset({"finite", "pulse length"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _spins,
    ),
    Limit(
        "too hard a blow",
        "a blow may exceed 1e10 m/s^2 or rad/s^2, where MuJoCo takes a state for lost",
        frozenset({"finite"}),
        _exceeds_numbers,
    ),
    Limit(
        "divided",
        "balls that meet in one step belong to two instances: what one delivers is a "
        "steady force to the other",
        frozenset({"pulse length"}) | _ENERGY | _SYMMETRY | _SHAPE,
        _is_divided,
    ),
    Limit(
        "out of slots",
        "more pulses under way than the state has slots: the rest is delivered at "
        "once, and which are the rest depends on the order",
        _SYMMETRY,
        _runs_out_of_slots,
    ),
)


def limit_of(evidence: Evidence, invariant: str) -> str:
    """Returns the name of the first limit that a case is outside of, "" if of none.

    MuJoCo's contacts have other limits; they are judged without any, but for scenes
    that diverge alone.
    """
    for limit in LIMITS if evidence.method == OURS else LIMITS[:1]:
        if invariant in limit.invariants and limit.holds(evidence):
            return limit.name
    return ""
