"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

START_KEYFRAME = "release"
"""Keyframe that a run starts from if the model has it and no other is asked for."""

ModelArgument = Annotated[
    str, typer.Argument(metavar="MODEL", help="Model file, or name of a shipped model.")
]
DurationOption = Annotated[float, typer.Option(help="Simulated time [s].")]
KeyframeOption = Annotated[
    str | None,
    typer.Option(
        help=f"Keyframe to start from, name or number, or 'none' "
        f"[default: {START_KEYFRAME!r} if the model has it]."
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Setting of the impact law; repeatable."
    ),
]
SpeedOption = Annotated[
    float | None,
    typer.Option(
        "--speed",
        help="Closing speed of the fastest impact expected [m/s]; sets the gap in "
        "which contacts are seen.",
    ),
]
ParamsOption = Annotated[
    Path | None,
    typer.Option(
        "--params",
        metavar="PARAMS.json",
        help="Parameters of the law calibrated, from `mujoco-impact calibrate`.",
    ),
]
FrictionOption = Annotated[
    bool,
    typer.Option("--friction", help="With the friction factors of --params, too."),
]
JsonOption = Annotated[
    str | None,
    typer.Option("--json", metavar="FILE", help="Write JSON; '-' is standard output."),
]
