"""Documented limits of cases of shapes, measured on the case."""

from __future__ import annotations

from functools import partial

from mujoco_impact.stress.promises import Limit
from mujoco_impact.stress.shapes.evidence import Evidence
from mujoco_impact.stress.shapes.invariants import GROWTH, axis_missed, kept_spin
from mujoco_impact.stress.shapes.stretches import stretches

LEVER = 10.0
"""Change of spin that an arm explains, over the arm: (1 + e) m u a = 2/5 m r² ω, and as
much again for bodies that are not balls."""


def _diverges_alone(evidence: Evidence) -> bool:
    return bool(evidence.run.warnings) and bool(evidence.alone.warnings)


def _is_integration(evidence: Evidence, *, native: bool) -> bool:
    """Whether the integrator itself changes energy as much, wherever it grows."""
    return all(
        stretch.growth <= stretch.integration
        for stretch in stretches(evidence)
        if stretch.native == native and stretch.growth > GROWTH
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
        "narrow phase",
        "the line of action that MuJoCo's collision detection finds misses the axis of "
        "symmetry by a tenth of the change of spin, or more",
        frozenset({"spin"}),
        _misses_axis,
        ours_only=False,
    ),
)
