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

DEAREST = 30
"""States from which a step has counted the most work, taken besides."""


@dataclasses.dataclass(frozen=True)
class Costs:
    """Costs of the steps of a run, over those of MuJoCo from the same states.

    Attributes:
        mean: Of all steps.
        still: Of the steps without an impact.
        struck: Part of the steps that have impacts.
        impact: Of those steps; nan if there is none.
        worst: Longest step, over the mean step with MuJoCo's contacts.
    """

    mean: float
    still: float
    struck: float
    impact: float
    worst: float


class CostSampler:
    """Keeps states of a run, to step from them again later."""

    def __init__(self, model: mujoco.MjModel, every: int) -> None:
        """Keeps every `every`-th state, and those whose step counts most work."""
        self._model, self._every = model, every
        self._kind = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        self._state = np.zeros(mujoco.mj_stateSize(model, self._kind))
        self._regular: list[tuple[float, Array]] = []
        self._dearest: list[tuple[float, Array]] = []
        self._step = 0

    def before_step(self, data: mujoco.MjData) -> None:
        """Notes the state."""
        mujoco.mj_getState(self._model, data, self._state, self._kind)

    def after_step(self, work: float) -> None:
        """Keeps it, or not, by the work that the step has counted."""
        if self._step % self._every == 0:
            self._regular.append((work, self._state.copy()))
        self._step += 1
        if work > 0 and (len(self._dearest) < DEAREST or work > self._dearest[-1][0]):
            self._dearest.append((work, self._state.copy()))
            self._dearest.sort(key=lambda pair: -pair[0])
            del self._dearest[DEAREST:]

    def measure(self, plain: mujoco.MjModel) -> Costs:
        """Steps from all that was kept, with our contacts and with those of `plain`."""
        data = mujoco.MjData(self._model), mujoco.MjData(plain)
        pairs = [
            self._pair(plain, data, state)
            for _, state in [*self._regular, *self._dearest]
        ]
        ours, stock = np.array(pairs).T
        number = len(self._regular)
        struck = np.array([work > 0 for work, _ in self._regular])

        def ratio(chosen: Array) -> float:
            steps = np.flatnonzero(chosen)
            if len(steps) == 0:
                return np.nan
            return float(ours[steps].sum() / stock[steps].sum())

        return Costs(
            mean=ratio(np.ones(number)),
            still=ratio(~struck),
            struck=float(struck.mean()),
            impact=ratio(struck),
            worst=float(ours.max() / stock[:number].mean()),
        )

    def _pair(
        self,
        plain: mujoco.MjModel,
        data: tuple[mujoco.MjData, mujoco.MjData],
        state: Array,
    ) -> tuple[float, float]:
        """Returns the least time of a step from a state, ours and MuJoCo's [s]."""
        ours, other = data
        least = [np.inf, np.inf]
        for _ in range(TURNS):
            mujoco.mj_setState(self._model, ours, state, self._kind)
            for name in ("qpos", "qvel", "act", "ctrl", "qacc_warmstart"):
                getattr(other, name)[:] = getattr(ours, name)
            other.time = ours.time
            for number, model in enumerate((self._model, plain)):
                begin = time.thread_time()
                mujoco.mj_step(model, data[number])
                least[number] = min(least[number], time.thread_time() - begin)
        return least[0], least[1]
