"""Stress tests: random scenes, long runs, and any scene of the user's own.

`sweep` judges random cases, each reproducible from its seed, by the promises in
`invariants`; what a case outside of the documented limits does is counted apart
(`limits`). `stress_scene` runs one scene in many ways. `report` writes docs/stress.md.
"""

from __future__ import annotations

from mujoco_impact.stress.case import Case
from mujoco_impact.stress.draw import case_of
from mujoco_impact.stress.evidence import Evidence
from mujoco_impact.stress.invariants import INVARIANTS
from mujoco_impact.stress.limits import LIMITS, limit_of
from mujoco_impact.stress.methods import DEFAULTS, METHODS, OURS, TUNED
from mujoco_impact.stress.summary import Summary, summarise
from mujoco_impact.stress.sweep import Outcome, judge, sweep
from mujoco_impact.stress.user_scene import Finding, stress_scene

__all__ = [
    "DEFAULTS",
    "INVARIANTS",
    "LIMITS",
    "METHODS",
    "OURS",
    "TUNED",
    "Case",
    "Evidence",
    "Finding",
    "Outcome",
    "Summary",
    "case_of",
    "judge",
    "limit_of",
    "stress_scene",
    "summarise",
    "sweep",
]
