"""The motions that a video of one scene shows: ours, MuJoCo's, the reference."""

from __future__ import annotations

import warnings
from typing import Any

import mujoco

from mujoco_impact.comparing.pendulums import find_row
from mujoco_impact.comparison import AS_IS, OURS, Comparison
from mujoco_impact.errors import ImpactError, ImpactWarning, SimulationError
from mujoco_impact.reference import swing
from mujoco_impact.runner import load_model, run
from mujoco_impact.scene import detach
from mujoco_impact.trajectory import Trajectory
from mujoco_impact.video.motion import Panel

MUJOCO = "MuJoCo's contacts"


def panels_of(comparison: Comparison) -> list[Panel]:
    """Returns MuJoCo's contacts as they are, ours, and the reference of a row."""
    motions = {one.name: one.trajectory for one in comparison.methods}
    native, ours = motions.get(AS_IS), motions.get(OURS)
    panels = [] if native is None else [Panel.of(native, MUJOCO)]
    if ours is not None:
        panels.append(Panel.of(ours, OURS))
        if comparison.reference is not None and comparison.row is not None:
            row, reference = comparison.row, comparison.reference
            panels.append(Panel.of_reference(reference, row, ours))
    return panels


def native_panel(spec: mujoco.MjSpec, duration: float, start: dict[str, Any]) -> Panel:
    """Returns the scene under MuJoCo's own contacts; if that fails, up to there."""
    plain = detach(spec)
    with warnings.catch_warnings():
        # what MuJoCo's own contacts do wrong is what the video shows
        warnings.simplefilter("ignore", ImpactWarning)
        try:
            return Panel.of(run(plain, duration=duration, **start), MUJOCO)
        except SimulationError as error:
            if error.trajectory is None:
                raise
            return Panel.of(error.trajectory, f"{MUJOCO} (fail at {error.time:.3g} s)")


def reference_panel(
    spec: mujoco.MjSpec, motion: Trajectory, settings: dict[str, Any]
) -> Panel | None:
    """Returns the Hertz reference of a row of pendulums; None for other scenes.

    Args:
        spec: The scene with our impacts.
        motion: Our motion, for the start.
        settings: Settings of the impact law.
    """
    if float(settings.get("restitution", 1.0)) != 1.0 or settings.get("law"):
        return None
    young = float(settings.get("young", 2e11))
    row = find_row(
        load_model(spec), young=young, poisson=float(settings.get("poisson", 0.3))
    )
    if row is None:
        return None
    angles, velocities = row.angles(motion.qpos[0]), row.angles(motion.qvel[0])
    try:
        reference = swing(row.chain, angles, velocities, float(motion.time[-1]))
    except ImpactError:  # a chain that it cannot follow
        return None
    return Panel.of_reference(reference, row, motion)
