"""The force of impacts over time, finer than the timestep.

A simulation at 2 ms has no samples within a contact of 0.1 ms, but the plugin's state
holds every pulse: onset, impulse and duration. The force at any rate follows from
the waveform in closed form, without a smaller timestep.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from mujoco_impact import law
from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.impact import Impact
from mujoco_impact.pulses import PulseReader
from mujoco_impact.trajectory import Array

RATE = 40_000.0
"""Default sampling rate [Hz]."""

_cumulative = np.vectorize(law.waveform_cumulative, otypes=[np.float64])


class ForceBuffer:
    """The forces of contacts over the last stretch of one running simulation.

    Each sample is the exact average of the force over its interval, so that the sum of
    the samples of a whole pulse, over the rate, is its impulse to rounding.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        pairs: Sequence[tuple[str, str]],
        *,
        duration: float,
        rate: float = RATE,
    ) -> None:
        """Starts with the impacts to come; make another one after a reset.

        Args:
            model: The model, with the plugin.
            data: The simulation; `poll` reads its state.
            pairs: Names of the two geoms of each contact, in either order.
            duration: How far the buffer reaches back [s].
            rate: Sampling rate [Hz].

        Raises:
            SceneError: If a geom is unknown.
            ConfigError: If duration × rate is not a whole number of samples.
        """
        for name in (name for pair in pairs for name in pair):
            if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name) < 0:
                raise SceneError(f"there is no geom {name!r} in the model")
        self._columns = {frozenset(pair): i for i, pair in enumerate(pairs)}
        self._shape = (sample_count(duration, rate), len(pairs))
        self._rate = rate
        self._data = data
        self._reader = PulseReader(model, data)
        self._taken = 0
        self._impacts: list[Impact] = []

    @property
    def missed(self) -> int:
        """Impacts whose slot was used again before `poll` could read it."""
        return self._reader.missed

    def poll(self) -> None:
        """Takes over the impacts that began since the last call.

        Call it after every physics step; it is cheap if there are none.
        """
        self._reader.poll()
        new = self._reader.impacts[self._taken :]
        self._taken += len(new)
        self._impacts += [one for one in new if frozenset(one.geoms) in self._columns]
        start = self._start()
        if self._impacts and self._impacts[0].time + self._impacts[0].duration < start:
            self._impacts = [
                one for one in self._impacts if one.time + one.duration >= start
            ]

    def read(self) -> Array:
        """Returns the forces of the stretch that ends now [N], shape (samples, pairs).

        Row 0 is the oldest. A force is >= 0, and pushes the geoms apart.
        """
        forces = np.zeros(self._shape)
        for impact in self._impacts:
            self._add(impact, forces)
        return forces

    def _start(self) -> float:
        """Returns the time at which the first sample begins [s]."""
        return float(self._data.time) - self._shape[0] / self._rate

    def _add(self, impact: Impact, forces: Array) -> None:
        """Adds the samples that a pulse reaches."""
        samples = self._shape[0]
        begin = (impact.time - self._start()) * self._rate
        end = begin + impact.duration * self._rate
        first, last = max(0, int(np.floor(begin))), min(samples, int(np.ceil(end)))
        if first >= last:
            return
        # F_i = P (I(t_i+1) - I(t_i)) rate, I the part of the impulse delivered by t
        phase = (np.arange(first, last + 1) - begin) / (impact.duration * self._rate)
        part = np.diff(_cumulative(phase, impact.restitution))
        column = self._columns[frozenset(impact.geoms)]
        forces[first:last, column] += impact.impulse * self._rate * part


def sample_count(duration: float, rate: float) -> int:
    """Returns duration × rate.

    Raises:
        ConfigError: If that is not a whole number, at least 1.
    """
    samples = round(duration * rate) if np.isfinite(duration * rate) else 0
    if samples < 1 or abs(samples - duration * rate) > 1e-6:
        msg = (
            f"{duration} s at {rate} Hz are {duration * rate} samples: duration × rate "
            "must be a whole number >= 1"
        )
        raise ConfigError(msg)
    return samples
