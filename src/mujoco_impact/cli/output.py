"""What commands write: text for people, progress, JSON, errors in one sentence."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Iterator
from typing import Any

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn

import cradle_models
from mujoco_impact.cli.console import PlainConsole
from mujoco_impact.errors import ImpactError
from mujoco_impact.files import write_text
from mujoco_impact.printable import printable

USER_ERROR = 2
"""Exit code when the input or the installation is to blame."""


@contextlib.contextmanager
def clean_errors() -> Iterator[None]:
    """Turns expected errors into one sentence on standard error and exit code 2."""
    try:
        yield
    except (ImpactError, cradle_models.CradleModelError, ValueError, OSError) as error:
        text = printable(" ".join(str(error).split()))
        typer.echo(f"mujoco-impact: {text}", err=True)
        raise typer.Exit(USER_ERROR) from error


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


def write_json(json_file: str | None, document: dict[str, Any]) -> None:
    """Writes a document to a file, or to standard output for "-"."""
    if json_file is None:
        return
    text = json.dumps(document, indent=2, allow_nan=False) + "\n"
    if json_file == "-":
        sys.stdout.write(text)
    else:
        write_text(json_file, text)
