"""Showing text that may hold anything."""

from __future__ import annotations


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
