"""The ways of computing impacts that are measured, and their settings."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TypeAlias

from mujoco_impact_lab.bench.samples import Simulation
from mujoco_impact_lab.bench.scenes import BenchScene
from mujoco_impact_lab.bench.truths import Truth

Build: TypeAlias = Callable[[BenchScene, Truth], Simulation]


@dataclasses.dataclass(frozen=True)
class Candidate:
    """One method with one setting: one point of a chart.

    Attributes:
        method: Name of the method.
        setting: What was set.
        timestep: Timestep [s]; None if it adapts.
        integrator: Integrator.
        build: Makes the simulation of a scene.
        comparable: Whether its run time is that of a simulator; if not, it is a
            reference and does not belong to the front.
        quick: Whether `--quick` measures it.
        sweep: Whether it belongs to a long sweep, for the main scenes only.
        rows_only: Whether it knows pendulum rows only.
        lossless_only: Whether it knows restitution 1 only.
        most_balls: Longer rows would take it minutes.
    """

    method: str
    setting: str
    timestep: float | None
    integrator: str
    build: Build
    comparable: bool = True
    quick: bool = False
    sweep: bool = False
    rows_only: bool = False
    lossless_only: bool = False
    most_balls: int = 1000

    def obstacle(self, scene: BenchScene) -> str:
        """Returns why the scene is not measured with this candidate, else empty."""
        if self.rows_only and not scene.is_row:
            return "simulates pendulum rows only"
        if self.lossless_only and scene.restitution != 1.0:
            return "knows restitution 1 only"
        if len(scene.pattern) > self.most_balls:
            return f"takes minutes for more than {self.most_balls} balls"
        if self.sweep and not scene.sweep:
            return "is a long sweep"
        return ""


@dataclasses.dataclass(frozen=True)
class MethodFamily:
    """All candidates of one method.

    Attributes:
        name: Name of the method, as `--methods` takes it.
        title: What it is, for legends.
        candidates: Its settings; none if it cannot run here.
        version: Version of the engine, empty for MuJoCo's and our own.
        missing: Why it cannot run here, else empty.
    """

    name: str
    title: str
    candidates: tuple[Candidate, ...]
    version: str = ""
    missing: str = ""
