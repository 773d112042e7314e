"""Documented limits of cases of shapes, measured on the case."""

from __future__ import annotations

from mujoco_impact.stress.promises import Limit
from mujoco_impact.stress.shapes.evidence import Evidence
from mujoco_impact.stress.shapes.invariants import GROWTH, axis_missed, kept_spin
from mujoco_impact.stress.shapes.stretches import stretches

LEVER = 10.0
"""Change of spin that an arm explains, over the arm: (1 + e) m u a = 2/5 m r² ω, and as
much again for bodies that are not balls."""


def _diverges_alone(evidence: Evidence) -> bool:
    return bool(evidence.run.warnings) and bool(evidence.alone.warnings)


def _is_integration(evidence: Evidence) -> bool:
    """Whether the integrator itself changes energy as much, wherever it grows."""
    return all(
        stretch.growth <= stretch.integration
        for stretch in stretches(evidence)
        if not stretch.native and stretch.growth > GROWTH
    )


def _misses_axis(evidence: Evidence) -> bool:
    """Whether MuJoCo's contacts of round bodies miss their axes by as much."""
    spin = kept_spin(evidence)
    return spin is not None and spin <= LEVER * axis_missed(evidence)


LIMITS = (
    Limit(
        "diverges without contacts",
        "MuJoCo cannot integrate the scene even if nothing meets",
        frozenset({"finite"}),
        _diverges_alone,
        ours_only=False,
    ),
    Limit(
        "integration",
        "MuJoCo's integrator changes the energy in the same steps without the impacts "
        "by as much as it grows",
        frozenset({"impact energy"}),
        _is_integration,
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
