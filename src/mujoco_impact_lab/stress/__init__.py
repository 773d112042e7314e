"""Stress tests: random scenes and long runs.

`sweep` judges random cases of a family, each reproducible from its seed, by the
promises of the family; what a case outside of the documented limits does is counted
apart. `shrunk` makes a case that breaks a promise simpler. `markdown` writes
docs/stress.md.
"""

from __future__ import annotations

from mujoco_impact_lab.stress.case import Case
from mujoco_impact_lab.stress.draw import case_of
from mujoco_impact_lab.stress.evidence import Evidence
from mujoco_impact_lab.stress.families import BALLS, FAMILIES, MATERIALS, SHAPES
from mujoco_impact_lab.stress.family import AnyCase, Family
from mujoco_impact_lab.stress.invariants import INVARIANTS
from mujoco_impact_lab.stress.limits import LIMITS, limit_of
from mujoco_impact_lab.stress.methods import DEFAULTS, METHODS, OURS, TUNED
from mujoco_impact_lab.stress.shrink import shrunk
from mujoco_impact_lab.stress.summary import Summary, summarise
from mujoco_impact_lab.stress.sweep import Outcome, digest, judge, sweep

__all__ = [
    "BALLS",
    "DEFAULTS",
    "FAMILIES",
    "INVARIANTS",
    "LIMITS",
    "MATERIALS",
    "METHODS",
    "OURS",
    "SHAPES",
    "TUNED",
    "AnyCase",
    "Case",
    "Evidence",
    "Family",
    "Outcome",
    "Summary",
    "case_of",
    "digest",
    "judge",
    "limit_of",
    "shrunk",
    "summarise",
    "sweep",
]
