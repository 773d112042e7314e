"""What single steps leave in `mjData`, kept for some steps and looked at together.

NumPy takes as long for one step as for a hundred: looking at every step by itself would
cost several times what the step costs.
"""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array

STEPS = 128
"""Steps looked at together."""


class StepLog:
    """Arrays of `mjData` after each of the latest steps.

    Attributes:
        count: Steps logged.
        start: Time at which the first of them started [s].
        qpos: Positions before the first of them, shape (nq,).
        qvel: Velocities before the first of them, shape (nv,).
    """

    def __init__(self, data: mujoco.MjData, names: Iterable[str]) -> None:
        """Starts at the state of `data`.

        Args:
            data: The data that is stepped.
            names: Arrays to keep; `qpos` and `qvel` always are.
        """
        names = sorted({"qpos", "qvel", *names})
        self._data = data
        # views of memory that stays where it is while the data lives
        views = {name: getattr(data, name) for name in names}
        self._kept = {
            name: np.zeros((STEPS, *view.shape)) for name, view in views.items()
        }
        self._pairs = [(self._kept[name], views[name]) for name in names]
        self.start_again()

    def add(self) -> bool:
        """Logs the step that was just taken; returns whether the log is full."""
        for kept, view in self._pairs:
            kept[self.count] = view
        self.count += 1
        return self.count == STEPS

    def __getitem__(self, name: str) -> Array:
        """Returns an array after each logged step, shape (count, ...)."""
        return self._kept[name][: self.count]

    def before(self, name: str) -> Array:
        """Returns `qpos` or `qvel` before each logged step, shape (count, ...)."""
        first: Array = getattr(self, name)[None]
        return np.concatenate([first, self[name]])[:-1]

    def start_again(self) -> None:
        """Forgets the steps; what the data holds now is before the next one."""
        self.count = 0
        self.start = float(self._data.time)
        self.qpos: Array = self._data.qpos.copy()
        self.qvel: Array = self._data.qvel.copy()
