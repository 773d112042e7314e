"""From a case that breaks a promise to the simplest one found that still does."""

from __future__ import annotations

from mujoco_impact_lab.stress.family import AnyCase, Family
from mujoco_impact_lab.stress.methods import OURS
from mujoco_impact_lab.stress.sweep import judge

PASSES = 3
"""How often all simplifications are tried in turn."""


def shrunk(case: AnyCase, invariant: str, family: Family) -> AnyCase:
    """Returns a simpler case that breaks the same promise of ours.

    Args:
        case: Of the family, one that breaks it.
        invariant: Name of the promise.
        family: The kind of the scene.
    """
    for _ in range(PASSES):
        before = case
        for simplify in family.simplifications(case):
            simpler = simplify(case)
            if simpler != case and _breaks(simpler, invariant, family):
                case = simpler
        if case == before:
            break
    return case


def _breaks(case: AnyCase, invariant: str, family: Family) -> bool:
    """Whether a case breaks a promise of ours within the limits."""
    return any(
        verdict.invariant == invariant and verdict.is_violation
        for verdict in judge(case, (OURS,), family=family).verdicts
    )
