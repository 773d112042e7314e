"""`mujoco-impact sweep`."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from concurrent.futures import Executor
from pathlib import Path
from typing import Annotated

import typer

from mujoco_impact.cli.output import (
    UNSOUND,
    check_outputs,
    clean_errors,
    console_of,
    progress,
)
from mujoco_impact.errors import ConfigError, SweepInterrupted
from mujoco_impact.extras import require_matplotlib


def sweep(
    specification: Annotated[
        Path, typer.Argument(metavar="SPEC.toml", help="What to vary and to record.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help="File of rows to write or to go on with: .csv, or .parquet, a folder "
            "[default: SPEC.csv]."
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture of what was varied against what was recorded."),
    ] = None,
    processes: Annotated[
        int | None,
        typer.Option(help="Processes of this machine [default: one per processor]."),
    ] = None,
    local: Annotated[
        int | None, typer.Option(help="Workers of dask on this machine, instead.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="tcp://HOST:PORT", help="Scheduler of dask that has workers."
        ),
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Throw away the rows that are there.")
    ] = False,
) -> None:
    """Run a scene with many parameters, and write a row for each case.

    The rows are written as they come. If it is interrupted, the same command goes on
    where it stopped. A specification names a scene, what to vary and what to record:

    ```toml
    duration = 0.5
    scene.model = "row_3"
    grid.timestep = [0.001, 0.002]
    grid.method = ["mujoco-impact", "MuJoCo damper"]
    record = ["velocity_error", "run_time"]
    ```
    """
    from mujoco_impact.sweeping.run_case import ERROR, REMARKS
    from mujoco_impact.sweeping.sweep import sweep as run_sweep

    console = console_of(None)
    with clean_errors():
        rows = out or Path(f"{specification.stem}.csv")
        check_outputs(plot)
        if plot is not None:
            require_matplotlib()
        given = {"--processes": processes, "--local": local, "--scheduler": scheduler}
        chosen = [name for name, value in given.items() if value is not None]
        if len(chosen) > 1:
            raise ConfigError(f"{' and '.join(chosen)}: give one of them")
        try:
            with _workers(local, scheduler) as executor, progress(None) as tell:
                found = run_sweep(
                    specification,
                    rows,
                    executor=executor,
                    processes=processes,
                    restart=restart,
                    progress=lambda done, total: tell(f"{done} of {total} rows"),
                )
        except SweepInterrupted:
            console.out(f"rows so far: {rows}; the same command goes on from there")
            raise
        console.out(f"{len(found.rows)} rows: {rows}")
        for some, what, column in (
            (found.failures, "failed", ERROR),
            (found.remarked, "have remarks", REMARKS),
        ):
            if some:
                console.out(
                    f"{len(some)} {what} (column {column}); the first, case "
                    f"{some[0]['case']}: {some[0][column]}"
                )
        if len(found.failures) == len(found.rows):
            raise typer.Exit(UNSOUND)
        if plot is not None:
            console.out(f"picture: {found.plot(plot)}")


@contextlib.contextmanager
def _workers(local: int | None, scheduler: str | None) -> Iterator[Executor | None]:
    """Yields workers of dask if they are asked for."""
    if local is None and scheduler is None:
        yield None
        return
    from mujoco_impact.sweeping.cluster import dask_workers

    with dask_workers(scheduler=scheduler, local=local) as executor:
        yield executor
