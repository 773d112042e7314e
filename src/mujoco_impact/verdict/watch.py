"""Watching a run, so that nothing goes wrong in it without a word."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from mujoco_impact.impact import Impact
from mujoco_impact.pulses import plugin_instances
from mujoco_impact.remarks import NATIVE, NO_IMPACT, Remark
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.encounters import Flags, meetings, owned_numbers
from mujoco_impact.verdict.energy_balance import EnergyBalance
from mujoco_impact.verdict.fast_bodies import FastBodies
from mujoco_impact.verdict.overlaps import Overlaps
from mujoco_impact.verdict.step_log import StepLog

NOTHING = (
    "no impact: none of the geoms that the plugin owns touched anything; run longer, "
    "or start from another state (keyframe, qpos, qvel)"
)
"""What is said of a run in which nothing touched."""

ALONE = (
    "nothing can collide: no geom that the plugin owns can meet another geom; see "
    "their contype and conaffinity, and the <exclude> of the scene"
)
"""What is said of a run in which nothing could touch."""

OWN_CONTACTS = (
    "the model has no mujoco-impact plugin: its contacts are MuJoCo's own; "
    "run(attach(scene), ...) has its impacts computed by the plugin"
)
"""What is said of a run without the plugin."""


class RunWatch:
    """Looks at every step of one run."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        every: int = 1,
        controlled: bool = False,
    ) -> None:
        """Starts at the state of `data`.

        Args:
            model: The model.
            data: The data that is stepped.
            every: Steps between two samples of the energies.
            controlled: Whether a controller may change state and applied forces.
        """
        owned = owned_numbers(model)
        self._native = not plugin_instances(model)
        self._can_meet = bool(meetings(model, owned).any())
        self._data = data
        self._owned = owned.size > 0
        self._fast = FastBodies(model, owned)
        self._overlaps = Overlaps(model, owned, data)
        self._balance = EnergyBalance(model, data, every=every, controlled=controlled)
        self._log = StepLog(data, (*self._balance.needs, *self._fast.needs))

    def after_controller(self) -> None:
        """Looks at what a controller has done, before the step."""
        self._balance.after_controller()

    def after_step(self) -> None:
        """Looks at the step that was just taken."""
        if self._owned:
            self._overlaps.after_step(self._data)
        self._balance.after_step()
        if self._log.add():
            self._look()

    def _look(self) -> None:
        """Looks at the logged steps."""
        if not self._log.count:
            return
        if self._owned:
            self._fast.look(self._log)
        self._balance.count(self._log)
        self._log.start_again()

    def remarks(
        self, time: Array, energy: Array, impacts: Sequence[Impact]
    ) -> tuple[Remark, ...]:
        """Returns what to say about the run.

        Args:
            time: Times of the samples [s], shape (n,).
            energy: Potential and kinetic energy of the samples [J], shape (n, 2).
            impacts: Impacts of the plugin.
        """
        self._look()
        if self._owned and np.isfinite(self._data.qpos).all():
            self._overlaps.look(self._data)
        growth = self._balance.growth(energy, quiet_samples(time, impacts))
        grew = None if growth is None else growth.remark()
        fast = self._fast.remark()
        if growth and fast and self._fast.found.first > time[growth.since]:
            # what has gained energy from nowhere is fast because of it
            found = [grew]
        elif fast is not None:
            # it explains what else went through or was never struck
            found = [fast, grew]
        else:
            found = [self._overlaps.remark(), grew]
            if self._owned and not impacts and not self._overlaps.touched:
                found.append(Remark(NO_IMPACT, NOTHING if self._can_meet else ALONE))
        if self._native:
            found.append(Remark(NATIVE, OWN_CONTACTS))
        return tuple(remark for remark in found if remark is not None)


def quiet_samples(time: Array, impacts: Sequence[Impact]) -> Flags:
    """Returns at which samples no pulse is under way, shape (n,)."""
    busy = np.zeros(len(time) + 1, dtype=np.int64)
    begin = np.array([impact.time for impact in impacts])
    length = np.array([impact.duration for impact in impacts])
    # the state of a step holds what the step delivered of pulses that began in it
    np.add.at(busy, np.searchsorted(time, begin, side="right"), 1)
    np.add.at(busy, np.searchsorted(time, begin + length, side="left"), -1)
    quiet: Flags = np.cumsum(busy)[:-1] == 0
    return quiet
