"""What a run comes to, and where two runs of one scene differ."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from mujoco_impact.impact import Impact
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict import quiet_samples

DIFFERENT = 2e-2
"""Difference that is told: of velocities over the fastest, of energies over the largest
kinetic one. Errors of the integrators are below where a timestep resolves a scene."""


@dataclasses.dataclass(frozen=True, eq=False)
class Outcome:
    """What is compared of a run.

    Attributes:
        time: Times of the samples, one per step [s], shape (n,).
        qvel: Velocities, shape (n, nv).
        impacts: The impacts in order of time.
        count: Their number, those without a record included.
        energy: Change of energy over the largest kinetic energy.
    """

    time: Array
    qvel: Array
    impacts: Sequence[Impact]
    count: int
    energy: float


def differences(one: Outcome, other: Outcome, other_name: str) -> tuple[str, ...]:
    """Returns where a run differs from another of the same scene, in words."""
    found = []
    change = _change_of_velocities(one, other)
    if change is not None and change > DIFFERENT:
        found.append(f"velocities after the first impact differ by {change:.2g}")
    if one.count != other.count:
        found.append(f"{one.count} impacts, not {other.count}")
    if not abs(one.energy - other.energy) <= DIFFERENT:
        found.append(f"energy changes by {one.energy:+.2g}, not {other.energy:+.2g}")
    if not found:
        return ()
    return (f"other than with {other_name}: {', '.join(found)}",)


def _change_of_velocities(one: Outcome, other: Outcome) -> float | None:
    """Returns the largest change of a velocity after the first impact.

    It is over the fastest velocity, at the first time at which the first impact is over
    in both runs; None if the next one has come by then.
    """
    spans = [_after_first(outcome) for outcome in (one, other)]
    if None in spans:
        return None
    known = [span for span in spans if span is not None]
    time = max(begin for begin, _ in known)
    if time > min(end for _, end in known):
        return None
    first, second = (_velocity_at(outcome, time) for outcome in (one, other))
    fastest = max(float(np.abs(first).max()), float(np.abs(second).max()), 1e-300)
    return float(np.abs(first - second).max()) / fastest


def _after_first(outcome: Outcome) -> tuple[float, float] | None:
    """Returns from when until when the velocities are those after the first impact."""
    if not outcome.impacts:
        return None
    quiet = quiet_samples(outcome.time, outcome.impacts)
    onsets = np.sort([impact.time for impact in outcome.impacts])
    over = np.flatnonzero(quiet & (outcome.time > onsets[0]))
    if not over.size:
        return None
    begin = float(outcome.time[over[0]])
    later = onsets[onsets > begin]
    return begin, float(later[0]) if later.size else float(outcome.time[-1])


def _velocity_at(outcome: Outcome, time: float) -> Array:
    """Returns the velocities at a time, between two samples on a line, shape (nv,)."""
    velocity: Array = np.array(
        [np.interp(time, outcome.time, column) for column in outcome.qvel.T]
    )
    return velocity
