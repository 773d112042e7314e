"""Reading the impacts of the engine plugin out of `plugin_state`.

Layout of the state of one instance, from `model.plugin_stateadr[instance]` on:
a header (layout version, number of pulses begun since reset, offset of the slot
table, numbers per slot, number of slots, clock: seconds stepped since reset), then the
slots. A slot holds the serial number of its pulse (0: never used), the two geoms, the
onset on that clock [s], the normal impulse [N s], alpha, the duration [s], the
restitution, the largest force [N], the closing speed [m/s] and the place (3) [m]; the
rest of it is private to the plugin and to this file. A finished pulse stays in its slot
until that is needed again.
"""

from __future__ import annotations

import math
from functools import cache

import mujoco
import numpy as np

from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.errors import PluginError
from mujoco_impact.impact import Impact, Vector
from mujoco_impact.trajectory import Array

LAYOUT_VERSION = 4.0

_COUNT, _TABLE, _SLOT_SIZE, _SLOTS, _CLOCK, _WORK = 1, 2, 3, 4, 5, 15
_SERIAL, _GEOM1, _GEOM2, _ONSET, _IMPULSE, _ALPHA, _DURATION = range(7)
_RESTITUTION, _PEAK, _CLOSING, _PLACE = 7, 8, 9, slice(10, 13)
_TANGENT, _NORMAL = slice(26, 29), slice(29, 32)

_PROBE = f"""
<mujoco>
  <extension>
    <plugin plugin="{PLUGIN_NAME}"><instance name="probe"/></plugin>
  </extension>
  <worldbody>
    <body><freejoint/><geom size="0.01" margin="-0.001" gap="0.002"/></body>
  </worldbody>
</mujoco>
"""


class PulseReader:
    """Collects the impacts of every plugin instance of one running simulation."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Starts after the pulses that `data` already holds.

        Raises:
            PluginError: If the state is not laid out as this package expects.
        """
        self._model = model
        self._data = data
        self.missed = 0
        self.impacts: list[Impact] = []
        self._states = [
            _instance_state(model, data, instance)
            for instance in plugin_instances(model)
        ]
        self._seen = [int(state[_COUNT]) for state in self._states]

    def poll(self) -> None:
        """Takes over the impacts that began since the last call.

        Call it after every step: a slot may be reused by a later pulse.
        """
        for index, state in enumerate(self._states):
            if state[_COUNT] != self._seen[index]:
                self._collect(index, state)

    def _collect(self, index: int, state: Array) -> None:
        """Records the new pulses of one instance."""
        seen, count = self._seen[index], int(state[_COUNT])
        slots = _slots(state)
        new = slots[slots[:, _SERIAL] > seen]
        new = new[np.argsort(new[:, _SERIAL])]
        clock = float(state[_CLOCK])
        self.impacts.extend(self._impact(slot, clock) for slot in new)
        self.missed += count - seen - len(new)
        self._seen[index] = count

    def _impact(self, slot: Array, clock: float) -> Impact:
        """Returns the record of one slot."""
        impulse, duration = float(slot[_IMPULSE]), float(slot[_DURATION])
        # the slot holds it over the normal impulse
        tangential = impulse * slot[_TANGENT]
        return Impact(
            time=self._data.time - (clock - float(slot[_ONSET])),
            geoms=(
                geom_name(self._model, int(slot[_GEOM1])),
                geom_name(self._model, int(slot[_GEOM2])),
            ),
            impulse=impulse,
            alpha=float(slot[_ALPHA]),
            height=math.pi * impulse / (2.0 * duration) if duration else math.inf,
            duration=duration,
            restitution=float(slot[_RESTITUTION]),
            peak=float(slot[_PEAK]),
            closing_speed=float(slot[_CLOSING]),
            position=_vector(slot[_PLACE]),
            normal=_vector(slot[_NORMAL]),
            tangential_impulse=_vector(tangential),
        )


def step_work(
    model: mujoco.MjModel, data: mujoco.MjData, instances: list[int]
) -> float:
    """Returns the counted work of the last step over its budget, the most of any.

    What is counted is told in `plugin/engine/resolve/budget.h`.
    """
    parts = [data.plugin_state[model.plugin_stateadr[i] + _WORK] for i in instances]
    return float(max(parts, default=0.0))


def plugin_instances(model: mujoco.MjModel) -> list[int]:
    """Returns the ids of the instances of our plugin in a model."""
    if model.nplugin == 0:
        return []
    return [
        int(instance) for instance in np.flatnonzero(model.plugin == plugin_number())
    ]


@cache
def plugin_number() -> int:
    """Returns the number under which our plugin is registered in this process.

    A model holds only the registration number of a plugin, not its name.
    """
    return int(mujoco.MjModel.from_xml_string(_PROBE).plugin[0])


def _vector(numbers: Array) -> Vector:
    """Returns three numbers as a tuple."""
    x, y, z = numbers.tolist()
    return x, y, z


def geom_name(model: mujoco.MjModel, geom: int) -> str:
    """Returns the name of a geom, or "geom ID" if it has none."""
    return model.geom(geom).name or f"geom {geom}"


def _instance_state(model: mujoco.MjModel, data: mujoco.MjData, instance: int) -> Array:
    """Returns a live view of the state of one instance."""
    start = int(model.plugin_stateadr[instance])
    state: Array = data.plugin_state[
        start : start + int(model.plugin_statenum[instance])
    ]
    if len(state) <= _CLOCK or state[0] != LAYOUT_VERSION:
        found = state[0] if len(state) else "no state"
        msg = (
            f"the plugin library keeps its state in layout {found}, this package reads "
            f"layout {LAYOUT_VERSION}: library and package are of different versions"
        )
        raise PluginError(msg)
    return state


def _slots(state: Array) -> Array:
    """Returns the slot table, shape (n_slots, numbers per slot)."""
    table, size, count = (int(state[i]) for i in (_TABLE, _SLOT_SIZE, _SLOTS))
    return state[table : table + size * count].reshape(count, size)
