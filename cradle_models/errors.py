"""Errors of the model package."""


class CradleModelError(Exception):
    """Base of every error raised by ``cradle_models``."""


class UnknownModelError(CradleModelError, KeyError):
    """No shipped model has the requested name."""

    # KeyError shows the repr of its argument, quotes and all; a sentence reads better.
    __str__ = Exception.__str__


class ModelValueError(CradleModelError, ValueError):
    """A model parameter lies outside the allowed range."""
