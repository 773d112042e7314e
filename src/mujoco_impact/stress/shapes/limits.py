"""Documented limits of cases of shapes, measured on the case."""

from __future__ import annotations

from mujoco_impact.stress.promises import Limit
from mujoco_impact.stress.shapes.evidence import Evidence
from mujoco_impact.stress.shapes.invariants import GROWTH
from mujoco_impact.stress.shapes.stretches import stretches


def _diverges_alone(evidence: Evidence) -> bool:
    return bool(evidence.run.warnings) and bool(evidence.alone.warnings)


def _is_integration(evidence: Evidence) -> bool:
    """Whether the integrator itself changes energy as much, wherever it grows."""
    return all(
        stretch.growth <= stretch.integration
        for stretch in stretches(evidence)
        if not stretch.native and stretch.growth > GROWTH
    )


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
)
