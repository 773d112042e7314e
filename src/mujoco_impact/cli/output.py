"""What commands write: text for people, progress, JSON, errors in one sentence."""

from __future__ import annotations

import contextlib
import json
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn
from rich.text import Text

import cradle_models
from mujoco_impact.errors import ImpactError, ImpactWarning
from mujoco_impact.files import check_writable, write_text
from mujoco_impact.remarks import ENERGY, Remark
from mujoco_impact.text import printable

UNSOUND = 1
"""Exit code when a run cannot be trusted, or a scene is not sound as it is."""

USER_ERROR = 2
"""Exit code when the input or the installation is to blame."""

INTERRUPTED = 130
"""Exit code when a command was interrupted by hand: 128 + SIGINT."""


class PlainConsole(Console):
    """A console that shows what would command the terminal as escape sequences."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Returns the text of a string or a cell of a table."""
        return super().render_str(printable(text), **options)

    def out(self, *objects: Any, **options: Any) -> None:
        """Prints text without styles."""
        super().out(*(printable(str(one)) for one in objects), **options)


@contextlib.contextmanager
def clean_errors() -> Iterator[None]:
    """Turns expected errors into one sentence on standard error and exit code 2.

    Warnings of this package become a sentence there, too, each text once; Ctrl-C ends
    with exit code 130.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", ImpactWarning)
            warnings.showwarning = _shown_once()
            yield
    except KeyboardInterrupt as stopped:
        typer.echo(f"mujoco-impact: {stopped or 'interrupted'}", err=True)
        raise typer.Exit(INTERRUPTED) from stopped
    except (ImpactError, cradle_models.CradleModelError, ValueError, OSError) as error:
        text = printable(" ".join(str(error).split()))
        typer.echo(f"mujoco-impact: {text}", err=True)
        raise typer.Exit(USER_ERROR) from error


def _shown_once() -> Callable[..., None]:
    """Returns what writes warnings to standard error, each text once.

    Where in the code a warning arose says nothing.
    """
    shown: set[str] = set()

    def show(message: Warning | str, *_: object, **__: object) -> None:
        text = " ".join(str(message).split())
        if text not in shown:
            typer.echo(f"mujoco-impact: warning: {text}", err=True)
        shown.add(text)

    return show


def check_outputs(*files: str | Path | None) -> None:
    """Raises OSError if a file could not be written: before anything is computed."""
    for file in files:
        if file is not None and str(file) != "-":
            check_writable(file)


def console_of(json_file: str | None) -> Console:
    """Returns where people read: standard error if standard output is JSON."""
    # no markup: headings and names may hold brackets
    return PlainConsole(stderr=json_file == "-", highlight=False, markup=False)


@contextlib.contextmanager
def progress(json_file: str | None) -> Iterator[Callable[[str], None]]:
    """Shows what is going on, on a terminal only; yields a function to tell it."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"))
    console = PlainConsole(stderr=True)
    hidden = not console.is_terminal or json_file == "-"
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("starting")
        yield lambda text: bar.update(task, description=text)


def exit_if_unsound(remarks: Iterable[Remark]) -> None:
    """Ends the command with exit code 1 if a run gained energy from nowhere."""
    if any(remark.kind == ENERGY for remark in remarks):
        raise typer.Exit(UNSOUND)


def write_json(json_file: str | None, document: dict[str, Any]) -> None:
    """Writes a document to a file, or to standard output for "-"."""
    if json_file is None:
        return
    text = json.dumps(document, indent=2, allow_nan=False) + "\n"
    if json_file == "-":
        sys.stdout.write(text)
    else:
        write_text(json_file, text)
