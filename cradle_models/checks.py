"""Checks of model parameters."""

import math

from cradle_models.errors import ModelValueError


def require_positive(name: str, value: float) -> None:
    """Raise unless `value` is a finite number above zero."""
    if not (math.isfinite(value) and value > 0):
        raise ModelValueError(f"{name} = {value}; allowed: finite and > 0")


def require_not_negative(name: str, value: float) -> None:
    """Raise unless `value` is a finite number, zero or above."""
    if not (math.isfinite(value) and value >= 0):
        raise ModelValueError(f"{name} = {value}; allowed: finite and >= 0")


def require_range(name: str, value: float, low: float, high: float) -> None:
    """Raise unless ``low <= value <= high``."""
    if not low <= value <= high:
        raise ModelValueError(f"{name} = {value}; allowed: {low} to {high}")
