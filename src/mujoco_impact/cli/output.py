"""What commands write: text for people, progress, JSON, errors in one sentence."""

from __future__ import annotations

import contextlib
import json
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn

import cradle_models
from mujoco_impact.cli.console import PlainConsole
from mujoco_impact.errors import ImpactError, ImpactWarning
from mujoco_impact.files import write_text
from mujoco_impact.printable import printable
from mujoco_impact.remarks import ENERGY, Remark

UNSOUND = 1
"""Exit code when a run cannot be trusted."""

USER_ERROR = 2
"""Exit code when the input or the installation is to blame."""


@contextlib.contextmanager
def clean_errors() -> Iterator[None]:
    """Turns expected errors into one sentence on standard error and exit code 2.

    Warnings of this package become a sentence there, too.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", ImpactWarning)
            warnings.showwarning = _show_warning
            yield
    except (ImpactError, cradle_models.CradleModelError, ValueError, OSError) as error:
        text = printable(" ".join(str(error).split()))
        typer.echo(f"mujoco-impact: {text}", err=True)
        raise typer.Exit(USER_ERROR) from error


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Writes a warning to standard error; where in the code it arose says nothing."""
    typer.echo(f"mujoco-impact: warning: {' '.join(str(message).split())}", err=True)


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
