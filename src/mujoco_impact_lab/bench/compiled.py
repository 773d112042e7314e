"""The Hertz chain integrated by compiled code without an engine: a lower bound.

`plugin/bench/hertz_chain.cc` resolves every impact in time, and nothing else: no
collision detection, no general bodies.
"""

from __future__ import annotations

import time

import numpy as np

from mujoco_impact.errors import SimulationError
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.library import library_obstacle, load_library
from mujoco_impact_lab.bench.methods import Candidate, MethodFamily
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP, BenchScene
from mujoco_impact_lab.bench.truths import Truth

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)

LONGEST_STEP = 0.01
"""Longest integration step [s]; an impact cannot be stepped over."""


class CompiledChain:
    """A row integrated by DOPRI5 with error control."""

    def __init__(self, scene: BenchScene, truth: Truth, tolerance: float) -> None:
        """Prepares a scene.

        Args:
            scene: The scene.
            truth: Its truth, for the chain.
            tolerance: Relative error per step.
        """
        chain = truth.chain
        self._count = chain.count
        self._row = [
            np.ascontiguousarray(values, dtype=np.float64)
            for values in (
                chain.weight_torque,
                chain.inertia,
                chain.stiffness,
                chain.gaps,
                chain.spacing,
            )
        ]
        self._length = chain.length
        self._start = scene.start()
        self._duration = scene.duration
        self._tolerance = tolerance

    def record(self) -> Samples:
        """Runs once, with a sample every 2 ms."""
        count = round(self._duration / BASE_TIMESTEP) + 1
        angles, velocities = self._run(count)
        times = np.arange(count, dtype=np.float64) * BASE_TIMESTEP
        return Samples(times, angles, velocities)

    def run_time(self) -> float:
        """Runs once without samples; returns the wall-clock time [s]."""
        begin = time.perf_counter()
        self._run(2)
        return time.perf_counter() - begin

    def _run(self, count: int) -> tuple[Array, Array]:
        """Returns angles and velocities at equidistant times, shape (count, n)."""
        angles = np.zeros((count, self._count))
        velocities = np.zeros_like(angles)
        angles[0], velocities[0] = self._start
        steps = load_library().hertz_chain_swing(
            self._count,
            self._length,
            *self._row,
            self._duration,
            self._tolerance,
            LONGEST_STEP,
            count,
            angles,
            velocities,
        )
        if steps < 0:
            msg = f"the compiled chain gave up after {-steps} steps"
            raise SimulationError(msg, time=0.0)
        return angles, velocities


def family() -> MethodFamily:
    """Returns the lower bound as a method."""
    name, title = "compiled-hertz", "compiled Hertz chain (no engine, lower bound)"
    missing = library_obstacle()
    if missing:
        return MethodFamily(name, title, (), missing=missing)

    def candidate(tolerance: float) -> Candidate:
        return Candidate(
            name,
            f"relative tolerance {tolerance:g}",
            None,
            "DOPRI5",
            lambda scene, truth: CompiledChain(scene, truth, tolerance),
            comparable=False,
            quick=tolerance == 1e-6,
            rows_only=True,
            lossless_only=True,
        )

    return MethodFamily(name, title, tuple(map(candidate, TOLERANCES)))
