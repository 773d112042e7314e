"""What must hold in every case with materials, beside what holds in every case."""

from __future__ import annotations

import numpy as np

from mujoco_impact.impact import Impact
from mujoco_impact_lab.stress.promises import Invariant
from mujoco_impact_lab.stress.shapes.evidence import Evidence
from mujoco_impact_lab.stress.shapes.materials import restitution_at

ROUNDING = 1e-12
"""Error of a coefficient that is rounding."""


def outside_of_materials(evidence: Evidence) -> float | None:
    """How far a restitution is outside of what its two materials, or its pair, say.

    Of impacts of one contact: the speed of the impact is its closing speed.
    """
    errors = []
    for impact in evidence.single.values():
        low, high = _restitutions(evidence, impact)
        errors.append(max(0.0, low - impact.restitution, impact.restitution - high))
    return max(errors, default=None)


def friction_beyond(evidence: Evidence) -> float | None:
    """Largest friction of an impact beyond that of its contact, over its impulse."""
    excess = [
        float(np.linalg.norm(impact.tangential_impulse)) / impact.impulse
        - _friction(evidence, impact)
        for impact in evidence.run.impacts
        if impact.impulse > 0
    ]
    return max(0.0, *excess) if excess else None


def depends_on_names(evidence: Evidence) -> float:
    """1 if the run ends in other bits with its materials named the other way round."""
    return float(evidence.run.bits != evidence.renamed.bits)


def _restitutions(evidence: Evidence, impact: Impact) -> tuple[float, float]:
    """Returns the least and the largest restitution that an impact may have."""
    said, speed = evidence.scene.materials, impact.closing_speed
    pair = restitution_at(speed, said.pair_of(*impact.geoms))
    if pair is not None:
        return pair, pair
    usual = evidence.case.restitution
    each = [restitution_at(speed, one) for one in said.each_of(*impact.geoms)]
    found = [usual if e is None else e for e in each]
    return min(found), max(found)


def _friction(evidence: Evidence, impact: Impact) -> float:
    """Returns the largest coefficient of friction that an impact may have."""
    if evidence.case.condim == 1:
        return 0.0
    said, model = evidence.scene.materials, evidence.scene.model
    pair = said.pair_of(*impact.geoms).friction
    if pair is not None:
        return pair
    return max(
        model.geom(geom).friction[0] if one.friction is None else one.friction
        for geom, one in zip(impact.geoms, said.each_of(*impact.geoms), strict=True)
    )


MATERIAL_INVARIANTS = (
    Invariant(
        "materials",
        "a contact has the restitution of its pair, or one between its two materials'",
        ROUNDING,
        "rounding; of impacts of one contact",
        outside_of_materials,
        ours_only=True,
    ),
    Invariant(
        "friction",
        "friction is at most its coefficient times the normal impulse",
        ROUNDING,
        "rounding; the coefficient of the pair, or the larger of the two",
        friction_beyond,
        ours_only=True,
    ),
    Invariant(
        "names",
        "names and order of materials and of the two of a pair do not matter",
        0.0,
        "exact: the same bits",
        depends_on_names,
        ours_only=True,
    ),
)
