"""Random scenes of every shape, of one material or of several: two families.

A `Case` is drawn from its seed, `scene_of` builds it, `Evidence` runs it, and
`INVARIANTS` judge what it shows. `scene_of(case).spec` is the scene as a specification,
with the plugin and the keyframe "start".
"""

from __future__ import annotations

from mujoco_impact_lab.stress.shapes.case import Case, Tree
from mujoco_impact_lab.stress.shapes.draw import case_of, case_with_materials
from mujoco_impact_lab.stress.shapes.evidence import Evidence
from mujoco_impact_lab.stress.shapes.invariants import INVARIANTS
from mujoco_impact_lab.stress.shapes.limits import LIMITS
from mujoco_impact_lab.stress.shapes.material_invariants import MATERIAL_INVARIANTS
from mujoco_impact_lab.stress.shapes.scene import scene_of
from mujoco_impact_lab.stress.shapes.simpler import simplifications
from mujoco_impact_lab.stress.shapes.story import story

__all__ = [
    "INVARIANTS",
    "LIMITS",
    "MATERIAL_INVARIANTS",
    "Case",
    "Evidence",
    "Tree",
    "case_of",
    "case_with_materials",
    "scene_of",
    "simplifications",
    "story",
]
