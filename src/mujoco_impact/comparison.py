"""The outcome of a comparison, as numbers."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import mujoco

from mujoco_impact import metrics
from mujoco_impact.pendulums import PendulumRow
from mujoco_impact.reference import ReferenceTrajectory
from mujoco_impact.remarks import Remark
from mujoco_impact.trajectory import Trajectory

OURS = "mujoco-impact"
"""Name of our own row in the table."""


@dataclasses.dataclass(frozen=True, eq=False)
class MethodResult:
    """What one method made of the scene.

    Attributes:
        name: Name of the method.
        setting: What was set, in MJCF terms.
        trajectory: The motion, sampled at the timestep of the scene; None if the
            simulation failed.
        failure: Why it failed, else empty.
        run_time: Wall-clock time of a simulated second [s], median; nan if it failed.
        cost: Run time over that of the scene with its own contacts, median of pairs.
        first_velocities: Velocities the first impact leaves, over its speed, in the
            order of the row; None if there is no reference.
        errors: Differences from the Hertz reference; None if there is none.
        energy_drift: Change of energy over the run; for a row in fractions of the
            energy at the start, else of the largest kinetic energy.
    """

    name: str
    setting: str
    trajectory: Trajectory | None
    failure: str = ""
    run_time: float = math.nan
    cost: float = math.nan
    first_velocities: tuple[float, ...] | None = None
    errors: metrics.RowErrors | None = None
    energy_drift: float = math.nan

    def row(self) -> dict[str, Any]:
        """Returns the numbers of this method for a table; None where there is none."""
        errors = self.errors
        return {
            "method": self.name,
            "setting": self.setting,
            "run_time": _number(self.run_time),
            "cost": _number(self.cost),
            "velocity_error": errors and _number(errors.velocity),
            "angle_rms": errors and _number(errors.angle_rms),
            "velocity_rms": errors and _number(errors.velocity_rms),
            "energy_drift": _number(self.energy_drift),
            "impacts": self._impacts(),
            "failure": self.failure,
        }

    def _impacts(self) -> int | None:
        """Returns the number of impacts; MuJoCo's own contacts do not count theirs."""
        if self.trajectory is None or self.name != OURS:
            return None
        return len(self.trajectory.impacts)


@dataclasses.dataclass(frozen=True, eq=False)
class Comparison:
    """The outcome of `compare`.

    Attributes:
        scene: Name of the model.
        duration: Simulated time [s].
        timestep: Timestep of the scene [s].
        integrator: Integrator of the scene.
        mujoco_version: Version of MuJoCo.
        impact_speed: Closing speed of the first impact, v0 [m/s].
        model: The scene with our impacts, compiled.
        geoms: Names of the geoms whose impacts are ours.
        methods: Our result, the scene as it is, and the tuned settings.
        row: The row of pendulums that the scene is, or None.
        reference: The Hertz reference of the row, or None.
        reference_velocities: Velocities the first impact of the reference leaves.
        note: Why there is no reference, else empty.
    """

    scene: str
    duration: float
    timestep: float
    integrator: str
    mujoco_version: str
    impact_speed: float
    model: mujoco.MjModel
    geoms: tuple[str, ...]
    methods: tuple[MethodResult, ...]
    row: PendulumRow | None = None
    reference: ReferenceTrajectory | None = None
    reference_velocities: tuple[float, ...] | None = None
    note: str = ""

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What our own run has to say, see `Trajectory`."""
        motion = self.method(OURS).trajectory
        return () if motion is None else motion.remarks

    def table(self) -> list[dict[str, Any]]:
        """Returns one dictionary of numbers per method, in order."""
        return [method.row() for method in self.methods]

    def method(self, name: str) -> MethodResult:
        """Returns the result of one method; KeyError if there is none."""
        for method in self.methods:
            if method.name == name:
                return method
        raise KeyError(name)

    def to_dict(self) -> dict[str, Any]:
        """Returns everything but the trajectories as plain numbers and text."""
        return {
            "scene": self.scene,
            "duration": self.duration,
            "timestep": self.timestep,
            "integrator": self.integrator,
            "mujoco_version": self.mujoco_version,
            "impact_speed": self.impact_speed,
            "reference_velocities": _list(self.reference_velocities),
            "note": self.note,
            "remarks": [dataclasses.asdict(remark) for remark in self.remarks],
            "methods": [
                {**method.row(), "first_velocities": _list(method.first_velocities)}
                for method in self.methods
            ],
        }


def _number(value: float) -> float | None:
    """Returns a number, or None for nan and inf, which JSON does not know."""
    return float(value) if math.isfinite(value) else None


def _list(values: tuple[float, ...] | None) -> list[float] | None:
    """Returns a tuple as a list, for JSON."""
    return None if values is None else list(values)
