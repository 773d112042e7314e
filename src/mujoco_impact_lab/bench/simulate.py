"""Simulating a scene with MuJoCo, sampled coarsely and timed without Python."""

from __future__ import annotations

import time

import mujoco
import numpy as np

from mujoco_impact.comparing.survey import HALF_STEP_INTEGRATORS
from mujoco_impact.errors import SimulationError
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.recorder import integrator_name
from mujoco_impact.runner import initial_data, load_model, step_count
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP, BenchScene

START = "release"
"""Keyframe that every scene starts from."""


class MujocoSimulation:
    """A scene in MuJoCo, with our impacts or with its own contacts."""

    def __init__(self, scene: BenchScene, spec: mujoco.MjSpec) -> None:
        """Compiles the scene.

        Args:
            scene: What the specification simulates.
            spec: The scene with its contacts set.
        """
        self.model = load_model(spec)
        self._start = initial_data(self.model, keyframe=START)
        self._data = mujoco.MjData(self.model)
        self._steps = step_count(self.model, scene.duration)

    def record(self) -> Samples:
        """Runs once, with a sample every 2 ms or every step.

        Raises:
            SimulationError: If MuJoCo gives a warning.
        """
        model = self.model
        timestep = float(model.opt.timestep)
        every = max(1, round(BASE_TIMESTEP / timestep))
        count = self._steps // every + 1
        data = self.restart()
        times = np.arange(count, dtype=np.float64) * (every * timestep)
        angles, velocities = np.zeros((count, model.nq)), np.zeros((count, model.nv))
        angles[0], velocities[0] = data.qpos, data.qvel
        with collected_warnings() as messages:
            for sample in range(1, count):
                mujoco.mj_step(model, data, nstep=every)
                if messages:
                    at = sample * every * timestep
                    msg = f"MuJoCo gave a warning before {at:.4g} s: {messages[0]}"
                    raise SimulationError(msg.strip(), time=at)
                angles[sample], velocities[sample] = data.qpos, data.qvel
        shifted = integrator_name(model) in HALF_STEP_INTEGRATORS
        return Samples(
            time=times,
            angles=angles,
            velocities=velocities,
            shift=timestep if shifted else 0.0,
        )

    def run_time(self) -> float:
        """Runs once by one call into MuJoCo; returns the wall-clock time [s]."""
        data = self.restart()
        with collected_warnings():
            begin = time.perf_counter()
            mujoco.mj_step(self.model, data, nstep=self._steps)
            return time.perf_counter() - begin

    def restart(self) -> mujoco.MjData:
        """Returns the data, put back to the start."""
        mujoco.mj_copyData(self._data, self.model, self._start)
        return self._data
