"""How far from a target counts for how much."""

from __future__ import annotations

import math

VALUE_AT_MARGIN = 0.1
"""Reward at the margin."""


def tolerance(value: float, *, low: float, high: float, margin: float) -> float:
    """Returns 1 for a value within [low, high], falling like a Gaussian outside.

    The shape is that of `dm_control.utils.rewards.tolerance`: with d the distance
    to the interval in units of the margin, exp(d² ln 0.1), which is 0.1 for d = 1.

    Args:
        value: The quantity.
        low: Lower bound of the target.
        high: Upper bound of the target; infinite for none.
        margin: Distance outside at which the reward is 0.1, > 0.
    """
    distance = max(low - value, value - high, 0.0) / margin
    return math.exp(distance**2 * math.log(VALUE_AT_MARGIN))
