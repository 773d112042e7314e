"""The outcome of a comparison, as numbers."""

from __future__ import annotations

import dataclasses
import math
import os
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mujoco_impact import metrics
from mujoco_impact.comparing.first_impact import FirstImpact
from mujoco_impact.comparing.pendulums import PendulumRow
from mujoco_impact.comparing.references import ImpactReference
from mujoco_impact.comparing.survey import Survey
from mujoco_impact.reference import ReferenceTrajectory
from mujoco_impact.remarks import Remark
from mujoco_impact.trajectory import Array, Trajectory

OURS = "mujoco-impact"
"""Name of our own row in the table."""

AS_IS = "MuJoCo as is"
"""Name of the row of the scene with its own contacts, unchanged."""

STRAIGHT = 1e-2
"""Part of the largest speed across a line up to which bodies move along it."""


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MethodResult:
    """What one method made of the scene.

    Attributes:
        name: Name of the method.
        setting: What was set, in MJCF terms.
        trajectory: The motion, sampled at the timestep of the scene; None if the
            simulation failed.
        failure: Why it failed, else empty.
        run_time: Wall-clock time of a simulated second [s], median; nan if unknown.
        cost: Run time over that of the scene with its own contacts, median of pairs.
        seen: What was seen of the motion; None if it failed.
        before: Velocities of the bodies of the first impact before it [m/s], shape
            (n, 3); None if its two geoms did not meet.
        after: Their velocities after it [m/s], shape (n, 3).
        first_velocities: Velocities the first impact of a row leaves, over its speed,
            in the order of the row; None if there is no reference of the row.
        errors: Differences from the reference of the row; None if there is none.
        first_error: RMS difference of the velocities after the first impact from its
            reference, over the closing speed; None if there is none.
    """

    name: str
    setting: str
    trajectory: Trajectory | None
    failure: str = ""
    run_time: float = math.nan
    cost: float = math.nan
    seen: Survey | None = None
    before: Array | None = None
    after: Array | None = None
    first_velocities: tuple[float, ...] | None = None
    errors: metrics.RowErrors | None = None
    first_error: float | None = None

    def __repr__(self) -> str:
        """Returns its name and whether it ran."""
        what = self.failure or f"{self.trajectory!r}"
        return f"<MethodResult {self.name!r}: {what}>"

    @property
    def velocity_error(self) -> float | None:
        """RMS error of the velocities after the first impact, over its speed."""
        return self.first_error if self.errors is None else self.errors.velocity


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """The outcome of `compare`.

    Attributes:
        scene: Name of the model.
        start: What all methods started from, such as "keyframe 'release'".
        duration: Simulated time [s].
        timestep: Timestep of the scene [s].
        integrator: Integrator of the scene.
        mujoco_version: Version of MuJoCo.
        impact_speed: Closing speed of the first impact, v0 [m/s].
        model: The scene with our impacts, compiled.
        geoms: Names of the geoms whose impacts are ours.
        methods: Our result, the scene as it is, and the tuned settings.
        first: The first impact of our motion.
        bodies: Names of its bodies, in the order of `MethodResult.before`.
        slowest: Closing speed from which meetings count as impacts [m/s].
        row: The row of pendulums that the scene is, or None.
        reference: The Hertz reference of the row, or None.
        reference_velocities: Velocities the first impact of the reference leaves.
        impact_reference: What the first impact of another scene should leave, or None.
        note: Why there is no reference, else empty.
    """

    scene: str
    start: str
    duration: float
    timestep: float
    integrator: str
    mujoco_version: str
    impact_speed: float
    model: mujoco.MjModel
    geoms: tuple[str, ...]
    methods: tuple[MethodResult, ...]
    first: FirstImpact
    bodies: tuple[str, ...]
    slowest: float
    row: PendulumRow | None = None
    reference: ReferenceTrajectory | None = None
    reference_velocities: tuple[float, ...] | None = None
    impact_reference: ImpactReference | None = None
    note: str = ""

    def __repr__(self) -> str:
        """Returns what is in it, in one line."""
        facts = [
            f"{self.scene!r} from {self.start}",
            f"{self.duration:g} s",
            f"{len(self.methods)} methods",
            f"first impact at {self.impact_speed:.3g} m/s",
        ]
        return f"<Comparison: {', '.join(facts)}>"

    def _repr_html_(self) -> str:
        """Returns what a notebook shows."""
        from mujoco_impact.report.notebook import comparison_html

        return comparison_html(self)

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What our own run has to say, see `Trajectory`."""
        motion = self.method(OURS).trajectory
        return () if motion is None else motion.remarks

    @property
    def energy_scale(self) -> float:
        """The largest energy of motion of ours, had all of it become speed [J]."""
        ours = self.method(OURS)
        if ours.trajectory is None or ours.seen is None:
            return 0.0
        return float(ours.seen.energy.max() - ours.trajectory.energy[:, 0].min())

    def table(self) -> list[dict[str, Any]]:
        """Returns one dictionary of numbers per method, in order.

        None stands where a number is not known.
        """
        return [self._row(method) for method in self.methods]

    def method(self, name: str) -> MethodResult:
        """Returns the result of one method; KeyError if there is none."""
        for method in self.methods:
            if method.name == name:
                return method
        raise KeyError(name)

    def line(self) -> Array | None:
        """Returns the line along which the bodies of the first impact move, shape (3,).

        It points as the fastest of them moves before the impact. None if they do not
        move along one line in our motion.
        """
        ours = self.method(OURS)
        if ours.before is None or ours.after is None:
            return None
        fastest = ours.before[np.argmax(np.linalg.norm(ours.before, axis=1))]
        line: Array = fastest / np.linalg.norm(fastest)
        everything = np.concatenate([ours.before, ours.after])
        across = everything - np.outer(everything @ line, line)
        straight = np.abs(across).max() < STRAIGHT * np.linalg.norm(fastest)
        return line if straight else None

    def best_tuned(self) -> MethodResult | None:
        """Returns MuJoCo's tuned setting of the smallest error, at the same timestep.

        None if no errors are known.
        """
        tuned = [
            method
            for method in self.methods
            if method.name not in (OURS, AS_IS)
            and method.velocity_error is not None
            and method.trajectory is not None
            and method.trajectory.timestep == self.timestep
        ]
        return min(tuned, key=lambda one: one.velocity_error or 0.0, default=None)

    def headline(self) -> str:
        """Returns the errors of ours, of MuJoCo's default and of its best setting.

        Empty if there is no reference.
        """
        best = self.best_tuned()
        ours = self.method(OURS).velocity_error
        default = self._known(AS_IS)
        if best is None or ours is None or best.velocity_error is None:
            return ""
        parts = [f"{OURS} {_percent(ours)}"]
        if default is not None:
            parts.append(f"MuJoCo's default {_percent(default)}")
        parts.append(f"its best setting here ({best.name}) "
                     f"{_percent(best.velocity_error)}")  # fmt: skip
        where = "velocity error of the first impact, in its speed"
        return f"{where}: {', '.join(parts)}"

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draws the comparison; see `plot.plot_comparison`."""
        from mujoco_impact.plot import plot_comparison

        return plot_comparison(self, path)

    def to_dict(self) -> dict[str, Any]:
        """Returns everything but the trajectories as plain numbers and text."""
        known = self.impact_reference
        return {
            "scene": self.scene,
            "start": self.start,
            "duration": self.duration,
            "timestep": self.timestep,
            "integrator": self.integrator,
            "mujoco_version": self.mujoco_version,
            "impact_speed": self.impact_speed,
            "bodies": list(self.bodies),
            "slowest_impact": self.slowest,
            "reference_velocities": _list(self.reference_velocities),
            "reference": known and known.name,
            "reference_after": None if known is None else known.velocities.tolist(),
            "note": self.note,
            "headline": self.headline(),
            "remarks": [dataclasses.asdict(remark) for remark in self.remarks],
            "methods": [
                {
                    **self._row(method),
                    "first_velocities": _list(method.first_velocities),
                }
                for method in self.methods
            ],
        }

    def _known(self, name: str) -> float | None:
        """Returns the velocity error of a method, None if it is not known."""
        found = [one for one in self.methods if one.name == name]
        return found[0].velocity_error if found else None

    def _row(self, method: MethodResult) -> dict[str, Any]:
        """Returns the numbers of one method."""
        errors, seen = method.errors, method.seen
        scale = self.energy_scale
        lost = None if seen is None or not scale else seen.lost / scale
        return {
            "method": method.name,
            "setting": method.setting,
            "run_time": _number(method.run_time),
            "cost": _number(method.cost),
            "velocity_error": _number(method.velocity_error),
            "angle_rms": errors and _number(errors.angle_rms),
            "velocity_rms": errors and _number(errors.velocity_rms),
            "impacts": seen and seen.impacts,
            "energy_lost": _number(lost),
            "deepest_overlap": seen and _number(seen.deepest),
            "passed": [] if seen is None else [list(pair) for pair in seen.passed],
            "before": None if method.before is None else method.before.tolist(),
            "after": None if method.after is None else method.after.tolist(),
            "failure": method.failure,
        }


def _number(value: float | None) -> float | None:
    """Returns a number, or None for nan and inf, which JSON does not know."""
    return float(value) if value is not None and math.isfinite(value) else None


def _list(values: tuple[float, ...] | None) -> list[float] | None:
    """Returns a tuple as a list, for JSON."""
    return None if values is None else list(values)


def _percent(part: float) -> str:
    """Returns a part as percent, two digits; rounding is no error."""
    return f"{100 * part:.2g} %" if part >= 1e-9 else "below 1e-7 %"
