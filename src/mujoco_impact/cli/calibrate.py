"""`mujoco-impact calibrate` and `mujoco-impact shots`, which makes data for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import cradle_models
from mujoco_impact import calibration
from mujoco_impact.cli.options import JsonOption
from mujoco_impact.cli.output import (
    check_outputs,
    clean_errors,
    console_of,
    progress,
    write_json,
)
from mujoco_impact.cli.report import (
    HtmlOption,
    check_report_options,
    command_line,
)
from mujoco_impact.cli.tables import combination_table, parameter_table
from mujoco_impact.errors import ConfigError

SeedOption = Annotated[
    int, typer.Option(min=0, max=2**32 - 1, help="Seed of all randomness.")
]

IMBALANCE = 0.1
"""More than this and the rows are hardly those of one impact."""


def calibrate(
    context: typer.Context,
    data: Annotated[
        Path, typer.Argument(metavar="DATA.csv", help="Shots, one row each.")
    ],
    out: Annotated[Path, typer.Option(help="File of parameters to write.")] = Path(
        "params.json"
    ),
    fix: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Parameter to hold; repeatable."),
    ] = None,
    folds: Annotated[
        int, typer.Option(help="Parts of the shots held out in turn; 0: none.")
    ] = calibration.FOLDS,
    kappa: Annotated[
        float, typer.Option(help="Unit factor of the S_w term of equation (6).")
    ] = calibration.DEFAULT_KAPPA,
    w0: Annotated[
        float, typer.Option(help="W_0 of equation (6) [s].")
    ] = calibration.DEFAULT_W0,
    seed: SeedOption = 0,
    html: HtmlOption = None,
    json_file: JsonOption = None,
) -> None:
    """Find the parameters of the law `calibrated` from measured shots."""
    with clean_errors():
        check_outputs(out, json_file)
        check_report_options(html)
        measured = calibration.read_shots(data)
        with progress(json_file) as report:
            found = calibration.calibrate(
                measured,
                fixed=_numbers(fix),
                folds=folds,
                kappa=kappa,
                w0=w0,
                seed=seed,
                progress=report,
            )
        written = found.save(out)
        write_json(json_file, {"parameters": found.settings, **found.to_dict()})
        _show(found, written, json_file)
        if html is not None:
            _write_report(context, found, measured, html)
            console_of(json_file).out(f"report: {html}")


def _write_report(
    context: typer.Context,
    found: calibration.Calibration,
    measured: calibration.Shots,
    html: Path,
) -> None:
    """Writes the report of a calibration."""
    from mujoco_impact.report import write_page
    from mujoco_impact.report.calibrations import calibration_page

    tables = [parameter_table(found)]
    if found.identifiability is not None:
        tables.append(combination_table(found.identifiability))
    command = command_line(context)
    facts = {"shots": str(context.params["data"]), "seed": str(context.params["seed"])}
    page = calibration_page(found, measured, tables, command=command, facts=facts)
    write_page(page, html)


def shots(
    pattern: Annotated[
        str, typer.Argument(help="Balls of the row, such as AAB; the first comes in.")
    ],
    out: Annotated[Path, typer.Option(help="CSV file to write.")] = Path("shots.csv"),
    count: Annotated[int, typer.Option(help="Number of shots.")] = 10,
    slowest: Annotated[float, typer.Option(help="Slowest impact [m/s].")] = 0.3,
    fastest: Annotated[float, typer.Option(help="Fastest impact [m/s].")] = 0.7,
    restitution: Annotated[float, typer.Option(help="Restitution of the balls.")] = 1.0,
    error: Annotated[
        float, typer.Option(help="Error of the cameras [m]; 0: exact shots.")
    ] = calibration.Camera.error,
    seed: SeedOption = 0,
) -> None:
    """Write synthetic shots: Hertz impacts seen by two 500 Hz cameras."""
    with clean_errors():
        check_outputs(out)
        made = calibration.synthetic_shots(
            cradle_models.balls(pattern),
            count=count,
            speeds=(slowest, fastest),
            restitution=restitution,
            camera=calibration.Camera(error=error) if error else None,
            seed=seed,
        )
        written = calibration.write_shots(made, out)
        console_of(None).out(f"{made.count} shots of {pattern} in {written}")


def _show(found: calibration.Calibration, written: Path, json_file: str | None) -> None:
    """Prints what a calibration found."""
    console = console_of(json_file)
    console.print(parameter_table(found))
    if found.identifiability is None:
        console.out(f"{found.shots} shots are too few to tell what they determine")
    else:
        console.print()
        console.print(combination_table(found.identifiability))
    share = found.evaluation / found.scale
    console.out(
        f"\nevaluation value {found.evaluation:.6f} kg m/s on {found.shots} shots, "
        f"{share:.2%} of the momentum exchanged"
    )
    if found.held_out is not None:
        console.out(f"on shots held out of the search {found.held_out:.6f} kg m/s")
    if found.imbalance > IMBALANCE:
        console.out(
            f"momentum is off by up to {found.imbalance:.0%} of what comes in: check "
            "the data"
        )
    if not found.converged:
        console.out("the search did not converge; try another --seed")
    console.out(f"parameters: {written}  (mujoco-impact run MODEL --params {written})")


def _numbers(pairs: list[str] | None) -> dict[str, float]:
    """Returns the parameters given as NAME=VALUE."""
    fixed: dict[str, float] = {}
    for pair in pairs or []:
        name, _, value = pair.partition("=")
        try:
            fixed[name.strip()] = float(value)
        except ValueError as error:
            msg = f"--fix {pair!r}: must be NAME=NUMBER, such as e=1"
            raise ConfigError(msg) from error
    return fixed
