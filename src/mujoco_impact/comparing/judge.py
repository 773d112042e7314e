"""What all methods of a comparison are measured against, and by."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from mujoco_impact import metrics
from mujoco_impact.comparing.first_impact import (
    find_first_impact,
    velocities_at,
    window_of,
)
from mujoco_impact.comparing.references import (
    ImpactReference,
    Material,
    impact_reference,
)
from mujoco_impact.comparing.rows import RowReference, row_reference, row_samples
from mujoco_impact.comparing.survey import rest_speed, survey
from mujoco_impact.comparison import Comparison, MethodResult
from mujoco_impact.errors import SceneError
from mujoco_impact.impact_list import small_speed
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.pulses import geom_name
from mujoco_impact.runner import load_model
from mujoco_impact.settings import DEFAULT_POISSON, DEFAULT_YOUNG
from mujoco_impact.starts import keyframe_names
from mujoco_impact.trajectory import Trajectory
from mujoco_impact.verdict import ALONE


class Judge:
    """What all methods of a scene are measured against: our motion, and references."""

    def __init__(
        self,
        attached: mujoco.MjSpec,
        plain: mujoco.MjSpec,
        motion: Trajectory,
        law: dict[str, Any],
    ) -> None:
        """Looks at our motion.

        Args:
            attached: The scene with the plugin.
            plain: The scene without it.
            motion: Our motion.
            law: Settings of the impact law.

        Raises:
            SceneError: If there is no impact in it.
        """
        self.model = load_model(attached)
        self._plain, self._names = load_model(plain), _names_of(attached)
        self._scene, self._motion = plain.modelname, motion
        self.material = Material(
            restitution=_number_setting(law, "restitution", 1.0),
            young=_number_setting(law, "young", DEFAULT_YOUNG),
            poisson=_number_setting(law, "poisson", DEFAULT_POISSON),
            friction=law.get("friction", "none") != "none",
            hertz=law.get("law", "hertz") == "hertz",
            uniform="materials" not in law,
        )
        rest = rest_speed(self._plain, motion)
        self._slowest = max(rest, small_speed(motion.impacts))
        self.ours = survey(self._plain, motion, ours=True, slowest=self._slowest)
        geoms = {geom_name(self.model, geom): geom for geom in range(self.model.ngeom)}
        first = find_first_impact(self._plain, motion, geoms)
        if first is None:
            raise SceneError(_nothing_told(self._plain, motion, rest))
        self.first = first
        self._row: RowReference | None = None
        self._impact: ImpactReference | None = None
        self._note = ""

    @property
    def speed(self) -> float:
        """Closing speed of the first impact [m/s]."""
        known = 0.0 if self._row is None else self._row.speed
        return known or self.first.closing_speed

    def find_references(self) -> None:
        """Finds what is known of the scene without an engine."""
        self._row = row_reference(self.model, self._motion, self.material)
        if self._row is not None:
            self._note = self._row.note
            return
        self._impact, self._note = impact_reference(
            self._plain, self._motion, self.ours, self.first, self.material
        )

    def measured(self, result: MethodResult) -> MethodResult:
        """Returns a result with what is measured of its motion."""
        motion = result.trajectory
        if motion is None:
            return result
        ours = motion is self._motion
        seen = self.ours
        if not ours:
            seen = survey(self._plain, motion, ours=False, slowest=self._slowest)
        result = self._with_speeds(dataclasses.replace(result, seen=seen), motion, ours)
        if self._row is None or self._row.motion is None:
            return result
        samples = row_samples(self._row.row, motion)
        left = metrics.velocity_after_first_impact(*samples, self._row.row.chain)
        return dataclasses.replace(
            result,
            first_velocities=tuple(left.tolist()),
            errors=metrics.row_errors(*samples, self._row.motion),
        )

    def _with_speeds(
        self, result: MethodResult, motion: Trajectory, ours: bool
    ) -> MethodResult:
        """Returns a result with the velocities before and after the first impact."""
        first, seen = self.first, result.seen
        if seen is None:
            return result
        window = (
            (first.before, first.after)
            if ours
            else window_of(self._plain, first, motion, seen)
        )
        if window is None:
            return result
        known = self._impact
        still = np.zeros((len(first.bodies), 3))
        free = still if known is None else known.free
        before, after = (
            velocities_at(motion, seen, sample, first.bodies, free) for sample in window
        )
        result = dataclasses.replace(result, before=before, after=after)
        if known is None:
            return result
        wrong = after - known.at(float(motion.time[window[1]]))
        error = float(np.sqrt(np.mean(np.sum(wrong**2, axis=1)))) / self.speed
        return dataclasses.replace(result, first_error=error)

    def comparison(
        self, duration: float, results: Sequence[MethodResult]
    ) -> Comparison:
        """Returns the outcome."""
        row = self._row
        bodies = tuple(
            self._plain.body(body).name or f"body {body}" for body in self.first.bodies
        )
        return Comparison(
            scene=self._scene,
            start=self._motion.start,
            duration=duration,
            timestep=self._motion.timestep,
            integrator=self._motion.integrator,
            mujoco_version=self._motion.mujoco_version,
            impact_speed=self.speed,
            model=self.model,
            geoms=self._names,
            methods=tuple(results),
            first=self.first,
            bodies=bodies,
            slowest=self._slowest,
            row=None if row is None else row.row,
            reference=None if row is None else row.motion,
            reference_velocities=None if row is None else row.velocities,
            impact_reference=self._impact,
            note=self._note,
        )


def _names_of(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Returns the names of the owned geoms of all instances."""
    owned = owned_geoms(spec).values()
    everything = tuple(geom.name for geom in spec.geoms)
    return tuple(
        name for names in owned for name in (everything if names is None else names)
    )


def _nothing_told(model: mujoco.MjModel, motion: Trajectory, rest: float) -> str:
    """Returns what is said of a scene without an impact."""
    if any(remark.text == ALONE for remark in motion.remarks):
        return ALONE
    names = [name or str(number) for number, name in enumerate(keyframe_names(model))]
    others = f" ({', '.join(names)})" if names else ""
    # a run lists these, too
    faster = f" faster than {rest:.2g} m/s" if motion.impacts else ""
    return (
        f"there is no impact{faster} within {motion.time[-1]:g} s from {motion.start}, "
        f"so there is nothing to compare: run longer, or start from another keyframe"
        f"{others} or state"
    )


def _number_setting(settings: dict[str, Any], name: str, usual: float) -> float:
    """Returns a setting that is one number; `attach` has checked that it is."""
    return float(settings.get(name, usual))
