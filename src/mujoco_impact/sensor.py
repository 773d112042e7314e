"""Reading the plugin's sensor: what impacts do to each owned geom.

Eleven numbers per owned geom, in the order of the tuple: force in the world frame,
averaged over the step (3) [N]; impulse of the current or last impact [N s]; its largest
force [N]; its alpha [-]; and since reset the impacts, the impulse in the world frame
(3) [N s], and the largest force [N]. An impact is with one other geom: points that
begin in the same step, such as the corners of a box that lands on a face, are one, and
their numbers are added.

All but the force stay, so a controller that looks only every so many steps misses
nothing: the difference of two readings of `total` is the impulse between them, and
that of `count` the impacts. As for every MuJoCo sensor, the values after `mj_step` are
of the state that the step started from, with the impacts of the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.trajectory import Array

NUMBERS_PER_GEOM = 11

IMPULSE = 3
"""Place of the impulse among the numbers of a geom."""


@dataclass(frozen=True, eq=False)
class SensorReading:
    """One reading for n owned geoms, as copies.

    Attributes:
        force: Force on the geom, world frame [N], shape (n, 3).
        impulse: Impulse of its current or last impact [N s], shape (n,).
        peak: Largest force of that impact [N], shape (n,): of the Hertz contacts, or
            of the waveforms if they have another duration.
        alpha: Its alpha [-], shape (n,).
        count: Impacts since reset, shape (n,).
        total: Impulse since reset, world frame [N s], shape (n, 3).
        largest: Largest peak since reset [N], shape (n,).
    """

    force: Array
    impulse: Array
    peak: Array
    alpha: Array
    count: Array
    total: Array
    largest: Array


def read_sensor(values: Array) -> SensorReading:
    """Returns the reading in the numbers of a sensor, shape (11 n,) or (n, 11)."""
    table = values.reshape(-1, NUMBERS_PER_GEOM)
    return SensorReading(
        force=table[:, :3].copy(),
        impulse=table[:, IMPULSE].copy(),
        peak=table[:, 4].copy(),
        alpha=table[:, 5].copy(),
        count=table[:, 6].copy(),
        total=table[:, 7:10].copy(),
        largest=table[:, 10].copy(),
    )


def sensor_slice(model: Any, name: str = "impact") -> slice:
    """Returns where the sensor of an instance lies in `mjData.sensordata`.

    The plugin leaves room for the elements of all tuples of the model; the slice
    holds the geoms that are owned.

    Args:
        model: The model (`mujoco.MjModel`).
        name: Name of the sensor and the tuple, as given to `attach`.

    Raises:
        SceneError: If the model has no such sensor of the plugin.
    """
    sensor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SENSOR, name)
    if sensor < 0 or model.sensor_type[sensor] != mujoco.mjtSensor.mjSENS_PLUGIN:
        msg = f"the model has no plugin sensor {name!r}: make it with attach()"
        raise SceneError(msg)
    start = int(model.sensor_adr[sensor])
    numbers = int(model.sensor_dim[sensor])
    owned = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TUPLE, name)
    if owned >= 0:
        first = int(model.tuple_adr[owned])
        elements = slice(first, first + int(model.tuple_size[owned]))
        # geoms with a negative number are not owned
        number = int(np.count_nonzero(model.tuple_objprm[elements] >= 0))
        numbers = NUMBERS_PER_GEOM * number
    return slice(start, start + numbers)
