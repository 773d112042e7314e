"""`python -m mujoco_impact_lab`: what the scripts of the project run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mujoco_impact.cli.output import clean_errors
from mujoco_impact_lab.bench.command import bench, friction
from mujoco_impact_lab.stress.command import stress

app = typer.Typer(
    name="python -m mujoco_impact_lab",
    help="Benchmarks, random scenes and coverage of calibrations.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    # the default mode would take units in brackets for markup
    rich_markup_mode="markdown",
)
app.command()(bench)
app.command()(friction)
app.command()(stress)


@app.command()
def table(results: Path, page: Path) -> None:
    """Write the table of a results.csv of the benchmark into a page."""
    from mujoco_impact_lab.bench.page import write_table

    with clean_errors():
        write_table(results, page)


@app.command()
def environments(folder: Path) -> None:
    """Measure environments, rollouts and policies; write JSON and a page."""
    from mujoco_impact_lab.bench.environments import run, write

    with clean_errors():
        for path in write(run(), folder):
            typer.echo(path)


@app.command()
def training(folder: Path) -> None:
    """Train policies under our contacts and MuJoCo's; write JSON and a picture."""
    from mujoco_impact_lab.training.comparison import run
    from mujoco_impact_lab.training.results import write

    with clean_errors():
        for path in write(run(typer.echo), folder):
            typer.echo(path)


@app.command()
def instructions(
    program: Path, friction_program: Path, step_program: Path, file: Path
) -> None:
    """Count the instructions of impacts and of steps under valgrind; write JSON."""
    from mujoco_impact_lab.bench.instructions import write_counts

    with clean_errors():
        write_counts(program, friction_program, step_program, file)


@app.command()
def coverage(page: Path) -> None:
    """Measure how often intervals of a calibration hold the truth; write the page."""
    from mujoco_impact_lab.coverage import write_page

    with clean_errors():
        write_page(page)
        typer.echo(page)


@app.command()
def warp(
    page: Path, worlds: Annotated[list[int] | None, typer.Option()] = None
) -> None:
    """Measure cradles beside MuJoCo Warp on the device at hand; write the page."""
    from mujoco_impact_lab.bench.warp_throughput import WORLDS, write_page

    with clean_errors():
        write_page(page, worlds or WORLDS, report=typer.echo)
        typer.echo(page)


@app.command()
def domains(page: Path) -> None:
    """Run whole domains with our contacts and with MuJoCo's; write the page."""
    from mujoco_impact_lab.domains.page import write_page

    with clean_errors():
        write_page(page, report=typer.echo)
        typer.echo(page)


if __name__ == "__main__":
    app()
