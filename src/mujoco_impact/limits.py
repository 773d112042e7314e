"""How long a simulation may be, and how much of it is kept."""

from __future__ import annotations

import math

LARGEST_RECORDING = 4_000_000_000
"""Most bytes that a run keeps, or that are read of a trajectory file."""

MOST_STEPS = 2**53
"""Most steps of a run: a double counts no further."""


def steps_of(duration: float, timestep: float) -> int:
    """Returns the number of steps that make up a duration, at least 1.

    Args:
        duration: Simulated time [s].
        timestep: Of the model [s].

    Raises:
        ValueError: If the duration is not a positive time, or too long.
    """
    if not (math.isfinite(duration) and duration > 0):
        msg = f"duration = {duration}: must be a time > 0 [s]"
        raise ValueError(msg)
    if duration / timestep > MOST_STEPS:
        msg = f"duration = {duration}: more than 2^53 steps of {timestep:g} s"
        raise ValueError(msg)
    return max(1, round(duration / timestep))


def check_recording(samples: int, numbers: int) -> None:
    """Raises ValueError if samples of so many numbers each are more than is kept."""
    size = 8 * samples * numbers
    if size > LARGEST_RECORDING:
        msg = (
            f"{samples:.3g} samples of {numbers} numbers take {size:.3g} bytes, "
            f"allowed: {LARGEST_RECORDING:.3g}; run shorter, or keep fewer samples"
        )
        raise ValueError(msg)
