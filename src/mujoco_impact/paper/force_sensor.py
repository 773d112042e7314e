"""The force-sensor experiment of Dondo and Noborio, section 3.

A 115 g ball on a string swings against a fixed sensor behind an acrylic plate, ten
shots from different heights, force sampled at 40 kHz. The paper concludes from its
figures 5 and 6 that the pulses of all shots are one waveform, scaled in height only.
Here the model `force_sensor` is run with three rules for the duration, to see which of
them does that.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

import cradle_models
from mujoco_impact.calibration.objective import DEFAULT_W0
from mujoco_impact.impact import Impact
from mujoco_impact.paper.patterns import RESTITUTION
from mujoco_impact.paper.printed import Array, printed
from mujoco_impact.pulses import PulseReader
from mujoco_impact.runner import initial_data
from mujoco_impact.scene import attach

STEEL_YOUNG, STEEL_POISSON = 2e11, 0.3
ACRYLIC_YOUNG, ACRYLIC_POISSON = 3.2e9, 0.37
"""Young's moduli [Pa] and Poisson's ratios; acrylic: data sheets of cast PMMA."""

GRID_POINTS = 400
"""Points on which the curves are compared."""


@dataclass(frozen=True, eq=False)
class Record:
    """What the sensor sees of one shot.

    Attributes:
        height: Height from which the ball was let go [m].
        time: Middle of each sample, from the onset of the pulse [s], shape (n,).
        force: Force on the sensor, averaged over each sample [N], shape (n,).
        sample: Time between two samples [s].
        impact: The impact, as the plugin reports it.
    """

    height: float
    time: Array
    force: Array
    sample: float
    impact: Impact

    @property
    def cumulated(self) -> tuple[Array, Array]:
        """Time from onset [s] at the end of each sample, and impulse by then [N s]."""
        return self.time + self.sample / 2, np.cumsum(self.force) * self.sample


@dataclass(frozen=True, eq=False)
class Series:
    """All shots under one rule for the duration.

    Attributes:
        rule: The rule in words.
        records: The shots, from the lowest height on.
        waveform_spread: Largest distance between two waveforms scaled by their height,
            in parts of the height.
        impulse_spread: The same of the cumulated impulses, each scaled by the height
            of its waveform, in parts of the mean of their ends.
        shape_spread: Largest distance between two waveforms scaled by their height
            and by their duration.
    """

    rule: str
    records: tuple[Record, ...]
    waveform_spread: float
    impulse_spread: float
    shape_spread: float

    def to_dict(self) -> dict[str, Any]:
        """Returns plain values for JSON, without the curves."""
        return {
            "rule": self.rule,
            "waveform_spread": self.waveform_spread,
            "impulse_spread": self.impulse_spread,
            "shape_spread": self.shape_spread,
            "shots": [
                {
                    "height": record.height,
                    "impulse": record.impact.impulse,
                    "peak": record.impact.height,
                    "duration": record.impact.duration,
                    "samples": len(record.force),
                }
                for record in self.records
            ],
        }


def equivalent_young() -> float:
    """Returns the modulus [Pa] that makes steel on steel as soft as steel on acrylic.

    The plugin takes one modulus for all bodies:
    1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 = 2 (1 - nu^2)/E.
    """
    steel = (1 - STEEL_POISSON**2) / STEEL_YOUNG
    acrylic = (1 - ACRYLIC_POISSON**2) / ACRYLIC_YOUNG
    return 2 * (1 - STEEL_POISSON**2) / (steel + acrylic)


def median_width() -> float:
    """Returns the median S_w of table 3."""
    patterns = cradle_models.PAPER_PATTERNS
    return float(np.median([printed(pattern).parameters.sw for pattern in patterns]))


def rules() -> dict[str, dict[str, Any]]:
    """Returns the settings of `attach` for each rule for the duration."""
    return {
        "W = 7.5 ms": {"duration": DEFAULT_W0},
        f"W by eq. (6), S_w = {median_width():.2f}": {
            "duration": "paper",
            "sw": median_width(),
        },
        "Hertz, steel on acrylic": {"duration": "hertz", "young": equivalent_young()},
    }


def experiment(progress: Callable[[str], None] | None = None) -> tuple[Series, ...]:
    """Runs all shots under each rule.

    Args:
        progress: Told what is going on.
    """
    series = []
    for rule, settings in rules().items():
        if progress is not None:
            progress(rule)
        series.append(_series(rule, _shots(settings)))
    return tuple(series)


def _shots(settings: dict[str, Any]) -> tuple[Record, ...]:
    """Returns the record of every keyframe of the model."""
    path = cradle_models.model_path("force_sensor")
    spec = attach(path, restitution=RESTITUTION, **settings)
    model = spec.compile()
    names = [model.key(i).name for i in range(model.nkey)]
    return tuple(_record(model, name) for name in names if name.startswith("shot_"))


def _record(model: mujoco.MjModel, keyframe: str) -> Record:
    """Runs one shot until its pulse is over."""
    data = initial_data(model, keyframe=keyframe)
    pulses = PulseReader(model, data)
    angle = float(data.qpos[0])
    arm = abs(float(model.geom("ball_1").pos[2]))
    step = float(model.opt.timestep)
    # half a period is enough for the ball to come back from the plate
    limit = math.ceil(math.pi * math.sqrt(arm / 9.81) / step)
    forces: list[float] = []
    for _ in range(limit):
        mujoco.mj_step(model, data)
        pulses.poll()
        if pulses.impacts:
            # sensors belong to the state that the step started from; on the ball, so
            # the sensor behind the plate feels the opposite
            forces.append(-float(data.sensordata[0]))
            if data.time - step > pulses.impacts[0].time + pulses.impacts[0].duration:
                break
    impact = pulses.impacts[0]
    end = float(data.time) - step
    time: Array = end + step * (0.5 - np.arange(len(forces), dtype=float)[::-1])
    height = arm * (1 - math.cos(angle))
    return Record(height, time - impact.time, np.array(forces), step, impact)


def _series(rule: str, records: tuple[Record, ...]) -> Series:
    """Returns the shots with how far they are from one another once scaled."""
    longest = max(record.impact.duration for record in records)
    grid = np.linspace(0, longest, GRID_POINTS)
    waveforms = [_waveform(record, grid) for record in records]
    shapes = [
        _waveform(record, grid / longest * record.impact.duration) for record in records
    ]
    # every impulse is scaled by the height of its waveform
    impulses = [
        np.interp(grid, *record.cumulated, 0) / record.impact.height
        for record in records
    ]
    ends = np.mean([curve[-1] for curve in impulses])
    return Series(
        rule,
        records,
        waveform_spread=float(np.ptp(waveforms, axis=0).max()),
        impulse_spread=float(np.ptp(impulses, axis=0).max() / ends),
        shape_spread=float(np.ptp(shapes, axis=0).max()),
    )


def _waveform(record: Record, time: Array) -> Array:
    """Returns force over height at times from onset; nothing outside the samples."""
    force = np.interp(time, record.time, record.force, 0, 0)
    scaled: Array = force / record.impact.height
    return scaled
