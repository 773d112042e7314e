"""The commands `bench` and `friction`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mujoco_impact.cli.options import JsonOption
from mujoco_impact.cli.output import (
    check_outputs,
    clean_errors,
    console_of,
    progress,
    write_json,
)
from mujoco_impact.extras import require_matplotlib


def bench(
    out: Annotated[
        Path, typer.Option(help="Folder for results.csv, results.json and charts.")
    ] = Path("benchmarks"),
    scenes: Annotated[
        str | None, typer.Option(help="Scenes, separated by commas [default: all].")
    ] = None,
    methods: Annotated[
        str | None, typer.Option(help="Methods, separated by commas [default: all].")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Only the recommended settings.")
    ] = False,
    steps: Annotated[
        bool, typer.Option(help="Time single steps and impacts, too.")
    ] = True,
    json_file: JsonOption = None,
) -> None:
    """Measure run time against error for many methods, and draw the charts."""
    from mujoco_impact_lab import bench as benchmark

    with clean_errors():
        check_outputs(json_file)
        require_matplotlib()
        stopped = None
        with progress(json_file) as report:
            try:
                results = benchmark.run_benchmark(
                    scenes=None if scenes is None else scenes.split(","),
                    methods=None if methods is None else methods.split(","),
                    quick=quick,
                    steps=steps,
                    progress=report,
                )
            except benchmark.BenchmarkInterrupted as interrupted:
                results, stopped = interrupted.results, interrupted
        files = benchmark.write_files(results, out)
        write_json(json_file, results.to_dict())
        benchmark.show(results, console_of(json_file))
        console_of(json_file).out(f"\n{len(files)} files in {out}")
        if stopped is not None:
            raise stopped


def friction(
    out: Annotated[
        Path, typer.Option(help="Folder for results.csv, results.json and charts.")
    ] = Path("benchmarks/friction"),
    page: Annotated[
        Path | None, typer.Option(help="Markdown page that has a place for the table.")
    ] = None,
    scenes: Annotated[
        str | None, typer.Option(help="Scenes, separated by commas [default: all].")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Only one setting of each method.")
    ] = False,
) -> None:
    """Measure run time against error of impacts with friction, and draw the charts."""
    from mujoco_impact_lab.bench import friction as benchmark

    with clean_errors():
        require_matplotlib()
        with progress(None) as report:
            results = benchmark.run_friction(
                scenes=None if scenes is None else scenes.split(","),
                quick=quick,
                progress=report,
            )
        files = benchmark.write_friction(results, out)
        if page is not None:
            benchmark.write_page(out / "results.json", page)
        typer.echo(benchmark.friction_table(results))
        typer.echo(benchmark.friction_failures(results))
        typer.echo(f"{len(files)} files in {out}")
