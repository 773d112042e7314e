"""What an impact costs, counted by the plugin and not timed."""

from __future__ import annotations

from mujoco_impact_lab.stress.shapes.evidence import Evidence

BUDGET = 1.5
"""Most work of a step over what the plugin allows itself: it ends what it began."""


def counted_work(evidence: Evidence) -> float:
    """Returns the most work of a step over its budget."""
    return float(evidence.run.work.max())
