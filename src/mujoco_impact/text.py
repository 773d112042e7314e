"""Text that people read: what was probably meant, what is shown of any text, tables."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Iterable, Sequence

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


def as_number(value: object) -> float | None:
    """Returns a value as a float, infinite if it is beyond; None if it is no number.

    A flag is none.
    """
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def printable(text: str) -> str:
    """Returns text with what could command a terminal shown as escape sequences.

    Line breaks stay: they are ours, or do no harm.
    """
    return "".join(
        letter
        if letter == "\n" or letter.isprintable()
        else letter.encode("unicode_escape").decode("ascii")
        for letter in text
    )


def markdown_table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns a table in markdown."""
    lines = [heading, ["---"] * len(heading), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
