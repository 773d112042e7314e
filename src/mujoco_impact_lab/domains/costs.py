"""What a step costs with our contacts, over what it costs with MuJoCo's.

Both take the same states, those of a run with our contacts. They take turns, and of
each the least time of several turns counts: what the machine does beside only adds.
"""

from __future__ import annotations

import dataclasses
import time

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array

TURNS = 7
"""Steps of each from every state."""

SLOWEST = 30
"""States whose step took longest in the run, taken besides."""


@dataclasses.dataclass(frozen=True)
class Costs:
    """Costs of the steps of a run.

    Attributes:
        mean: Time of all steps, over that with MuJoCo's contacts.
        worst: Longest step, over the mean step with MuJoCo's contacts.
        worst_here: The same over the step of MuJoCo from the same state.
    """

    mean: float
    worst: float
    worst_here: float


class CostSampler:
    """Keeps states of a run, to step from them again later."""

    def __init__(self, model: mujoco.MjModel, every: int) -> None:
        """Keeps every `every`-th state, and those whose step takes longest."""
        self._model, self._every = model, every
        self._kind = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        self._size = mujoco.mj_stateSize(model, self._kind)
        self._regular: list[Array] = []
        self._slowest: list[tuple[float, Array]] = []
        self._step = 0
        self._state = np.zeros(self._size)

    def before_step(self, data: mujoco.MjData) -> None:
        """Notes the state."""
        mujoco.mj_getState(self._model, data, self._state, self._kind)
        self._begin = time.thread_time()

    def after_step(self) -> None:
        """Keeps it, or not."""
        seconds = time.thread_time() - self._begin
        if self._step % self._every == 0:
            self._regular.append(self._state.copy())
        self._step += 1
        if len(self._slowest) < SLOWEST or seconds > self._slowest[-1][0]:
            self._slowest.append((seconds, self._state.copy()))
            self._slowest.sort(key=lambda pair: -pair[0])
            del self._slowest[SLOWEST:]

    def measure(self, plain: mujoco.MjModel) -> Costs:
        """Steps from all that was kept, with our contacts and with those of `plain`."""
        regular = np.array([self._pair(plain, state) for state in self._regular])
        slowest = np.array([self._pair(plain, state) for _, state in self._slowest])
        ours, stock = np.concatenate([regular, slowest]).T
        usual = float(regular[:, 1].mean())
        return Costs(
            mean=float(regular[:, 0].sum() / regular[:, 1].sum()),
            worst=float(ours.max()) / usual,
            worst_here=float((ours / stock).max()),
        )

    def _pair(self, plain: mujoco.MjModel, state: Array) -> tuple[float, float]:
        """Returns the least time of a step from a state, ours and MuJoCo's [s]."""
        ours, other = mujoco.MjData(self._model), mujoco.MjData(plain)
        start = mujoco.MjData(self._model)
        mujoco.mj_setState(self._model, start, state, self._kind)
        least = [np.inf, np.inf]
        for _ in range(TURNS):
            mujoco.mj_setState(self._model, ours, state, self._kind)
            for name in ("qpos", "qvel", "act", "ctrl", "qacc_warmstart"):
                getattr(other, name)[:] = getattr(start, name)
            other.time = start.time
            for number, (model, data) in enumerate(
                ((self._model, ours), (plain, other))
            ):
                begin = time.thread_time()
                mujoco.mj_step(model, data)
                least[number] = min(least[number], time.thread_time() - begin)
        return least[0], least[1]
