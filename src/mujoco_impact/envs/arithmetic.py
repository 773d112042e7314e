"""What the rules of tasks compute with, for one environment and for many.

A rule is written once. In one environment its numbers are plain ones, which take a
tenth of the time of small arrays; in many they are arrays with one for each. Both come
to the same bits on every processor: numpy's own functions differ from those of C in the
last bit, so that C's are called for each number of an array.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

Number = Any
"""A float or bool, or an array of them, shape (environments,)."""


def where(condition: Number, value: Number, other: Number) -> Number:
    """Returns the value where the condition holds, and the other one elsewhere."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, value, other)
    return value if condition else other


def larger(one: Number, other: Number) -> Number:
    """Returns the larger of two numbers, the first of which tells their kind."""
    return np.maximum(one, other) if isinstance(one, np.ndarray) else max(one, other)


def of_numbers(function: Callable[..., float]) -> Callable[..., Number]:
    """Returns a function of floats as one of numbers, all of the same kind."""

    def apply(first: Number, *others: Number) -> Number:
        if isinstance(first, np.ndarray):
            each = map(function, first.tolist(), *(one.tolist() for one in others))
            return np.fromiter(each, dtype=np.float64, count=len(first))
        return function(first, *others)

    return apply


cosine = of_numbers(math.cos)
hypotenuse = of_numbers(math.hypot)

VALUE_AT_MARGIN = 0.1
"""Reward at the margin of `tolerance`."""

_EXPONENT = math.log(VALUE_AT_MARGIN)

_bell = of_numbers(lambda distance: math.exp(distance**2 * _EXPONENT))


def tolerance(value: Number, *, low: Number, high: Number, margin: Number) -> Number:
    """Returns 1 for a value within [low, high], falling like a Gaussian outside.

    The shape is that of `dm_control.utils.rewards.tolerance`: with d the distance
    to the interval in units of the margin, exp(d² ln 0.1), which is 0.1 for d = 1.

    Args:
        value: The quantity.
        low: Lower bound of the target.
        high: Upper bound of the target; infinite for none.
        margin: Distance outside at which the reward is 0.1, > 0.
    """
    outside = larger(larger(low - value, value - high), 0.0)
    return _bell(outside / margin)
