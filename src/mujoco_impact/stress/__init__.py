"""Stress tests: random scenes, long runs, and any scene of the user's own.

`sweep` judges random cases of a family, each reproducible from its seed, by the
promises of the family; what a case outside of the documented limits does is counted
apart. `shrunk` makes a case that breaks a promise simpler. `stress_scene` runs one
scene in many ways. `markdown` writes docs/stress.md.
"""

from __future__ import annotations

from mujoco_impact.stress.case import Case
from mujoco_impact.stress.draw import case_of
from mujoco_impact.stress.evidence import Evidence
from mujoco_impact.stress.families import BALLS, FAMILIES, SHAPES
from mujoco_impact.stress.family import AnyCase, Family
from mujoco_impact.stress.invariants import INVARIANTS
from mujoco_impact.stress.limits import LIMITS, limit_of
from mujoco_impact.stress.methods import DEFAULTS, METHODS, OURS, TUNED
from mujoco_impact.stress.shrink import shrunk
from mujoco_impact.stress.summary import Summary, summarise
from mujoco_impact.stress.sweep import Outcome, judge, sweep
from mujoco_impact.stress.user_scene import Finding, StressInterrupted, stress_scene

__all__ = [
    "BALLS",
    "DEFAULTS",
    "FAMILIES",
    "INVARIANTS",
    "LIMITS",
    "METHODS",
    "OURS",
    "SHAPES",
    "TUNED",
    "AnyCase",
    "Case",
    "Evidence",
    "Family",
    "Finding",
    "Outcome",
    "StressInterrupted",
    "Summary",
    "case_of",
    "judge",
    "limit_of",
    "shrunk",
    "stress_scene",
    "summarise",
    "sweep",
]
