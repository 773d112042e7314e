"""Starting episodes of stock environments as if the margins were the stock ones.

Tasks of dm_control look for a start without contacts by `mjData.ncon`, which counts
the contacts that the plugin's margins have MuJoCo detect early, too. While an
episode is set up, the model therefore has the margins it had before, so that it starts
in the same state, bit for bit.
"""

from __future__ import annotations

from typing import Any

import mujoco

_MARGINS = ("geom_margin", "geom_gap", "pair_margin", "pair_gap")


class StockStart:
    """Stands in for `task.initialize_episode` of one environment."""

    def __init__(self, task: Any, stock: mujoco.MjModel) -> None:
        """Remembers the task's own way, and the margins of the stock model."""
        self._task = task
        self._margins = {name: getattr(stock, name).copy() for name in _MARGINS}

    def __call__(self, physics: Any) -> None:
        """Sets up an episode under the stock margins."""
        model = physics.model
        ours = {name: getattr(model, name).copy() for name in _MARGINS}
        self._set(model, self._margins)
        try:
            # the method of the class: that of the instance is this object
            type(self._task).initialize_episode(self._task, physics)
        finally:
            self._set(model, ours)

    def _set(self, model: Any, margins: dict[str, Any]) -> None:
        """Writes margins into a model."""
        for name, values in margins.items():
            getattr(model, name)[:] = values
