"""What an impact costs, counted and not timed: the place for it.

The plugin does not count its work yet. Once its state does, `counted_work` reads it
there, and the promise in `invariants` judges it.
"""

from __future__ import annotations

from mujoco_impact.stress.shapes.evidence import Evidence

BUDGET = 1.0
"""Most work of a step, over what the plugin allows itself."""


def counted_work(_evidence: Evidence) -> float | None:
    """Returns the most work of a step over its budget; None: it is not counted."""
    return None
