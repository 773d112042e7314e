"""Making points: one accuracy run, and run times in turn with MuJoCo's defaults."""

from __future__ import annotations

import dataclasses
import math
import statistics

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


class SceneBench:
    """One scene: its truth, and the run that every other one is compared with."""

    def __init__(self, scene: BenchScene, truth: Truth, effort: Effort) -> None:
        """Prepares the scene.

        Args:
            scene: The scene.
            truth: Its truth.
            effort: How thoroughly to time.
        """
        self.scene = scene
        self.truth = truth
        self._effort = effort
        self._base = MujocoSimulation(scene, scene.spec())
        timed(self._base)

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
        try:
            simulation = candidate.build(self.scene, self.truth)
            errors = self._errors(simulation)
        except ImpactError as error:
            return dataclasses.replace(blank, failure=" ".join(str(error).split()))
        cost, run_time = self._cost(simulation)
        return dataclasses.replace(
            blank,
            cost=cost,
            run_time=run_time / self.scene.duration,
            velocity_error=errors.velocity,
            angle_rms=errors.angle_rms,
            energy_drift=errors.energy_drift,
        )

    def _errors(self, simulation: Simulation) -> Errors:
        """Runs once and compares the motion with the truth."""
        samples = simulation.record()
        if isinstance(simulation, MujocoSimulation) and not self.scene.is_row:
            return string_errors(self.scene, self.truth, simulation, samples)
        return row_errors(self.scene, self.truth, samples)

    def _cost(self, simulation: Simulation) -> tuple[float, float]:
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


def timed(simulation: Simulation) -> float:
    """Returns the run time [s]; of short runs the fastest of several."""
    fastest = spent = simulation.run_time()
    while spent < SHORTEST_TIMING:
        took = simulation.run_time()
        fastest = min(fastest, took)
        spent += took
    return fastest
