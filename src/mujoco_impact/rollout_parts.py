"""A part of the simulations of a rollout, done in one call of MuJoCo."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from mujoco_impact.errors import SimulationError
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.encounters import owned_numbers
from mujoco_impact.verdict.fast_bodies import Approaches, FastBodies

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
"""What the states of a rollout hold: time, positions, velocities, activations and the
state of the plugin."""

CHUNK_BYTES = 64e6
"""Size of the states of one call of MuJoCo; `every` thins them after each call."""


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """What is done with every initial state.

    Attributes:
        model: The model.
        steps: Number of steps.
        every: Steps between two samples.
    """

    model: mujoco.MjModel
    steps: int
    every: int

    @property
    def numbers(self) -> int:
        """Numbers that a step gives."""
        return int(mujoco.mj_stateSize(self.model, STATE) + self.model.nsensordata)

    def rows_per_call(self, threads: int) -> int:
        """Returns how many simulations fit into one call; a multiple of the threads."""
        fitting = int(CHUNK_BYTES / (8 * self.numbers * self.steps))
        return max(1, fitting // threads) * threads


@dataclasses.dataclass(frozen=True, eq=False)
class Part:
    """Some of the simulations.

    Attributes:
        first: Number of the first of them.
        start: Initial states, shape (n, n_state).
        control: Controls, shape (n, steps, nu), or None.
    """

    first: int
    start: Array
    control: Array | None


@dataclasses.dataclass(frozen=True, eq=False)
class Simulated:
    """What became of a part.

    Attributes:
        states: Time, positions and velocities of the samples, shape (n, n_samples,
            1 + nq + nv).
        sensors: Sensors of the samples, shape (n, n_samples, nsensordata).
        final: States at the end, shape (n, n_state).
        approaches: Bodies that were too fast for their gap.
    """

    states: Array
    sensors: Array
    final: Array
    approaches: Approaches


class Simulator:
    """Simulates parts, on this thread or on those of a pool."""

    def __init__(self, plan: Plan, pool: Rollout | None = None, threads: int = 1):
        """Takes what is to be done.

        Args:
            plan: What is done with every initial state.
            pool: Threads of MuJoCo; by default this one. With a pool the simulator
                cannot be pickled.
            threads: Their number.
        """
        self._plan = plan
        self._pool = pool
        self._threads = threads

    def __call__(self, part: Part) -> Simulated:
        """Simulates a part.

        Raises:
            SimulationError: If MuJoCo gives a warning.
        """
        plan, model = self._plan, self._plan.model
        pool = self._pool or Rollout(nthread=0)
        # of each call: an executor of threads calls one simulator many times at once
        workers = [mujoco.MjData(model) for _ in range(self._threads)]
        with collected_warnings() as messages:
            states, sensors = pool.rollout(
                model, workers, part.start, part.control, nstep=plan.steps
            )
        if messages:
            raise _failure(model, part, states, messages[0])
        samples = slice(plan.every - 1, plan.steps, plan.every)
        return Simulated(
            states=states[:, samples, : 1 + model.nq + model.nv].copy(),
            sensors=sensors[:, samples].copy(),
            final=states[:, -1].copy(),
            approaches=_approaches(model, states),
        )


def _approaches(model: mujoco.MjModel, states: Array) -> Approaches:
    """Looks for bodies that are too fast for their gap."""
    fast = FastBodies(model, owned_numbers(model))
    nq, nv = model.nq, model.nv
    rows = states.reshape(-1, states.shape[-1])
    fast.look_at_fastest(rows[:, 0], rows[:, 1 : 1 + nq], rows[:, 1 + nq : 1 + nq + nv])
    return fast.found


def _failure(
    model: mujoco.MjModel, part: Part, states: Array, message: str
) -> SimulationError:
    """Returns the error that says which simulation failed, and when."""
    # MuJoCo repeats the state after a warning, or has reset it: time does not go on
    time = np.concatenate([part.start[:, None, 0], states[:, :, 0]], axis=1)
    going = np.diff(time, axis=1) > 0.5 * model.opt.timestep
    row = int(np.argmin(going.all(axis=1)))
    last = float(time[row, int(np.argmin(going[row]))])
    return SimulationError(
        f"MuJoCo gave a warning in simulation {part.first + row} by {last:.6g} s: "
        f"{message.strip()}",
        time=last,
    )
