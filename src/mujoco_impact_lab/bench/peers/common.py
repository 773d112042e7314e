"""What the other engines have in common."""

from __future__ import annotations

import abc
import importlib.metadata
import importlib.util
import time
from collections.abc import Sequence

import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.methods import Candidate, MethodFamily
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import BenchScene
from mujoco_impact_lab.bench.truths import Truth


class SteppedEngine(abc.ABC):
    """A row in an engine that is stepped from Python."""

    shift = 1.0
    """Half-step offset of its integrator, see `Samples.shift`, in timesteps."""

    def __init__(self, scene: BenchScene, truth: Truth, timestep: float) -> None:
        """Prepares a scene.

        Args:
            scene: The scene.
            truth: Its truth, for masses, radii and lengths.
            timestep: Timestep [s].
        """
        self.chain = truth.chain
        self.restitution = scene.restitution
        self.start, _ = scene.start()
        # the pivots of the row as it is simulated, gaps or overlaps included
        spacing = self.chain.spacing - np.array(self.chain.gaps) + scene.gap
        self.pivots: Array = np.concatenate(([0.0], np.cumsum(spacing)))
        self.timestep = timestep
        self.steps = round(scene.duration / timestep)

    @abc.abstractmethod
    def restart(self) -> None:
        """Puts the row to its start, in a world made anew where that is simplest."""

    @abc.abstractmethod
    def step(self, count: int) -> None:
        """Makes some steps."""

    @abc.abstractmethod
    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Returns angles [rad] and angular velocities [rad/s]."""

    def record(self) -> Samples:
        """Runs once, with a sample every step."""
        self.restart()
        states = [self.state()]
        for _ in range(self.steps):
            self.step(1)
            states.append(self.state())
        angles, velocities = np.array(states, dtype=float).transpose(1, 0, 2)
        times = np.arange(self.steps + 1, dtype=np.float64) * self.timestep
        return Samples(times, angles, velocities, self.shift * self.timestep)

    def run_time(self) -> float:
        """Runs once; making the world is not counted."""
        self.restart()
        begin = time.perf_counter()
        self.step(self.steps)
        return time.perf_counter() - begin


def stepped_family(
    name: str,
    title: str,
    engine: type[SteppedEngine],
    *,
    package: str,
    setting: str,
    timesteps: Sequence[float],
    quick: float,
) -> MethodFamily:
    """Returns an engine as a method with one setting and several timesteps.

    Args:
        name: Name of the method.
        title: What it is.
        engine: The engine.
        package: Distribution that installs it; the module is called the same.
        setting: What was set.
        timesteps: Timesteps [s].
        quick: The timestep that `--quick` measures [s].
    """
    version = installed(package)
    if version is None:
        return missing(name, title, package)

    def candidate(timestep: float) -> Candidate:
        return Candidate(
            name,
            setting,
            timestep,
            "semi-implicit",
            lambda scene, truth: engine(scene, truth, timestep),
            quick=timestep == quick,
            rows_only=True,
        )

    return MethodFamily(name, title, tuple(map(candidate, timesteps)), version)


def installed(package: str) -> str | None:
    """Returns the version of an installed distribution; its module has its name."""
    if importlib.util.find_spec(package) is None:
        return None
    return importlib.metadata.version(package)


def missing(name: str, title: str, package: str) -> MethodFamily:
    """Returns a method without candidates, and why."""
    reason = f"not installed ({package}; scripts/bench)"
    return MethodFamily(name, title, (), missing=reason)
