"""A console that file and scene names cannot command."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.text import Text

from mujoco_impact.printable import printable


class PlainConsole(Console):
    """A console that shows what would command the terminal as escape sequences."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Returns the text of a string or a cell of a table."""
        return super().render_str(printable(text), **options)

    def out(self, *objects: Any, **options: Any) -> None:
        """Prints text without styles."""
        super().out(*(printable(str(one)) for one in objects), **options)
