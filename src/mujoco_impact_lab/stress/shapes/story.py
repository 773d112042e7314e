"""What happened in a case of shapes, in lines to read."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from mujoco_impact_lab.stress.shapes.evidence import Evidence
from mujoco_impact_lab.stress.shapes.invariants import GROWTH
from mujoco_impact_lab.stress.shapes.stretches import Stretch, stretches

WORST = 3
"""How many stretches are told."""


def story(evidence: Evidence) -> Iterator[str]:
    """Yields warnings, and the steps in which energy grew most, with their contacts."""
    run = evidence.run
    yield from (f"MuJoCo warns: {' '.join(text.split())}" for text in run.warnings[:1])
    if not run.is_sound:
        return
    worst = sorted(stretches(evidence), key=lambda s: s.growth, reverse=True)
    for stretch in worst[:WORST]:
        if stretch.growth <= GROWTH:
            return
        yield (
            f"energy +{stretch.growth:.2g} in the steps {stretch.first} to "
            f"{stretch.last} (+-{stretch.integration:.2g} by the integrator)"
            + (", MuJoCo's own contacts push" if stretch.native else "")
        )
        yield from (f"  {line}" for line in _contacts(evidence, stretch))


def _contacts(evidence: Evidence, stretch: Stretch) -> Iterator[str]:
    """Yields the contacts that a stretch starts with, and its impulses."""
    model, case = evidence.scene.model, evidence.case
    data = mujoco.MjData(model)
    data.qpos[:] = evidence.run.qpos[stretch.first]
    data.qvel[:] = evidence.run.qvel[stretch.first]
    mujoco.mj_fwdPosition(model, data)
    for contact in data.contact:
        names = " on ".join(_geom(model, int(geom)) for geom in contact.geom)
        yield f"contact {names}: distance {contact.dist:.3g} m"
    until = np.concatenate([[0], np.cumsum(evidence.run.begun)])
    begin = stretch.first * case.timestep
    for impact in evidence.run.impacts[until[stretch.first] : until[stretch.last + 1]]:
        names = " on ".join(
            _geom(model, int(model.geom(name).id)) for name in impact.geoms
        )
        yield (
            f"impact {names}: {impact.impulse:.3g} N s within {impact.duration:.2g} s, "
            f"after {(impact.time - begin) / case.timestep:.3f} steps"
        )
    change = np.array2string(
        evidence.run.qvel[stretch.last + 1] - evidence.run.qvel[stretch.first],
        precision=3,
        max_line_width=200,
    )
    yield f"change of qvel: {change}"


def _geom(model: mujoco.MjModel, geom: int) -> str:
    """Returns the name and the type of a geom."""
    kind = mujoco.mjtGeom(int(model.geom_type[geom])).name.removeprefix("mjGEOM_")
    return f"{model.geom(geom).name} ({kind.lower()})"
