"""Naming what was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MOST_NAMED = 20
"""Names that a message lists at most."""


def closest(name: str, names: Iterable[str]) -> str:
    """Returns "; did you mean 'shot'?" or nothing, and what is available.

    Args:
        name: What was asked for, and is not there.
        names: What is there.
    """
    known = [one for one in names if one]
    near = difflib.get_close_matches(name, known, n=2)
    hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
    shown = ", ".join(known[:MOST_NAMED])
    more = f" and {len(known) - MOST_NAMED} more" if len(known) > MOST_NAMED else ""
    return f"{hint} (available: {shown or 'none'}{more})"
