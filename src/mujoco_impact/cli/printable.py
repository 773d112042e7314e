"""Showing text that may hold anything on a terminal."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.text import Text


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


class PlainConsole(Console):
    """A console that prints names of files and scenes as they are, but no commands."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Returns the text of a string or a cell of a table."""
        return super().render_str(printable(text), **options)

    def out(self, *objects: Any, **options: Any) -> None:
        """Prints text without styles."""
        super().out(*(printable(str(one)) for one in objects), **options)
