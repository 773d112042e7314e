"""What every way of simulating a scene has in common."""

from __future__ import annotations

import dataclasses
from typing import Protocol

from mujoco_impact.trajectory import Array


@dataclasses.dataclass(frozen=True, eq=False)
class Samples:
    """A motion of a row.

    Attributes:
        time: Times [s], shape (t,).
        angles: Angles [rad], positive along the row, shape (t, n).
        velocities: Angular velocities [rad/s], shape (t, n).
        shift: Steps [s] whose half the positions are ahead of `time` for a start
            from rest: the timestep for semi-implicit Euler (velocity first), minus the
            timestep if positions are stepped first, 0 for other integrators.
    """

    time: Array
    angles: Array
    velocities: Array
    shift: float = 0.0


class Simulation(Protocol):
    """One way of simulating one scene, ready to run any number of times."""

    def record(self) -> Samples:
        """Runs once and returns the motion; not timed."""

    def run_time(self) -> float:
        """Runs once from the start and returns the wall-clock time [s]."""
