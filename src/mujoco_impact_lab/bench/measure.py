"""Making points: one accuracy run, and run times in turn with MuJoCo's defaults."""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Callable
from functools import partial
from typing import Protocol, TypeVar

from mujoco_impact.errors import ImpactError
from mujoco_impact_lab.bench.methods import Candidate
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.samples import Simulation
from mujoco_impact_lab.bench.scenes import BenchScene
from mujoco_impact_lab.bench.simulate import MujocoSimulation
from mujoco_impact_lab.bench.strings import string_errors
from mujoco_impact_lab.bench.truths import Errors, Truth, row_errors

SHORTEST_TIMING = 5e-3
"""Shorter runs are repeated and the fastest counts: the clock and the scheduler of
the operating system would dominate them [s]."""


LONG_ENOUGH = 1.0
"""One timing that takes so long is enough: disturbances average out in it [s]."""


@dataclasses.dataclass(frozen=True)
class Effort:
    """How thoroughly run times are measured.

    Attributes:
        repeats: Number of timings of each candidate.
        budget: Time spent on a candidate after which fewer timings must do [s].
        least: Timings of each candidate, unless they take very long.
    """

    repeats: int = 7
    budget: float = 0.4
    least: int = 3


QUICK = Effort(repeats=3, budget=0.1, least=1)


class Timed(Protocol):
    """What can be run for its time."""

    def run_time(self) -> float:
        """Runs once from the start and returns the wall-clock time [s]."""


S = TypeVar("S", bound=Timed)


class Race:
    """Points of one scene: errors, and run times in turn with those of one run."""

    def __init__(self, base: Timed, duration: float, effort: Effort) -> None:
        """Runs once, to warm up.

        Args:
            base: The run whose time all others are compared with.
            duration: Simulated time of every run [s].
            effort: How thoroughly to time.
        """
        self._base = base
        self._duration = duration
        self._effort = effort
        timed(base)

    def point(
        self, blank: Point, build: Callable[[], S], errors: Callable[[S], Errors]
    ) -> Point:
        """Measures one way of simulating the scene; a failure is a result.

        Args:
            blank: The point without numbers.
            build: Makes the simulation.
            errors: Runs it and compares the motion with the truth.
        """
        try:
            simulation = build()
            found = errors(simulation)
        except ImpactError as error:
            return dataclasses.replace(blank, failure=" ".join(str(error).split()))
        cost, run_time = self._cost(simulation)
        return dataclasses.replace(
            blank,
            cost=cost,
            run_time=run_time / self._duration,
            velocity_error=found.velocity,
            angle_rms=found.angle_rms,
            energy_drift=found.energy_drift,
        )

    def _cost(self, simulation: Timed) -> tuple[float, float]:
        """Returns cost ratio and run time [s], medians."""
        ratios, times = list[float](), list[float]()
        spent, before = 0.0, timed(self._base)
        while len(times) < self._effort.repeats:
            enough = len(times) >= self._effort.least or spent > LONG_ENOUGH
            if enough and spent > self._effort.budget:
                break
            took = timed(simulation)
            after = timed(self._base)
            ratios.append(2.0 * took / (before + after))
            times.append(took)
            spent += took + after
            before = after
        return statistics.median(ratios), statistics.median(times)


class SceneBench:
    """One scene of balls in a row: its truth, and the run to compare with."""

    def __init__(self, scene: BenchScene, truth: Truth, effort: Effort) -> None:
        """Prepares the scene.

        Args:
            scene: The scene.
            truth: Its truth.
            effort: How thoroughly to time.
        """
        self.scene = scene
        self.truth = truth
        base = MujocoSimulation(scene, scene.spec())
        self._race = Race(base, scene.duration, effort)

    def point(self, candidate: Candidate) -> Point:
        """Measures one candidate; a failure is a result."""
        blank = Point(
            scene=self.scene.name,
            method=candidate.method,
            setting=candidate.setting,
            integrator=candidate.integrator,
            timestep=math.nan if candidate.timestep is None else candidate.timestep,
            comparable=candidate.comparable,
        )
        build = partial(candidate.build, self.scene, self.truth)
        return self._race.point(blank, build, self._errors)

    def _errors(self, simulation: Simulation) -> Errors:
        """Runs once and compares the motion with the truth."""
        samples = simulation.record()
        if isinstance(simulation, MujocoSimulation) and not self.scene.is_row:
            return string_errors(self.scene, self.truth, simulation, samples)
        return row_errors(self.scene, self.truth, samples)


def timed(simulation: Timed) -> float:
    """Returns the run time [s]; of short runs the fastest of several."""
    fastest = spent = simulation.run_time()
    while spent < SHORTEST_TIMING:
        took = simulation.run_time()
        fastest = min(fastest, took)
        spent += took
    return fastest
