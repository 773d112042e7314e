"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import cradle_models
from mujoco_impact.materials import MATERIALS
from mujoco_impact.settings import SETTINGS
from mujoco_impact.starts import RELEASE

STANDARD_INPUT = "-"
"""Model that is read from standard input."""


def complete_model(incomplete: str) -> list[str]:
    """Returns shipped models and model files that begin like this."""
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    files = [
        f"{file}/" if file.is_dir() else str(file)
        for file in folder.glob("*")
        if file.is_dir() or file.suffix.lower() in _ENDINGS
    ]
    names = [*cradle_models.list_models(), *sorted(files)]
    return [name for name in names if name.startswith(incomplete)]


_ENDINGS = (".xml", ".mjcf", ".urdf", ".mjz", ".zip")

ModelArgument = Annotated[
    str,
    typer.Argument(
        metavar="MODEL",
        help="Model file, name of a shipped model, or '-' for standard input.",
        autocompletion=complete_model,
    ),
]
DurationOption = Annotated[float, typer.Option(help="Simulated time [s].")]
KeyframeOption = Annotated[
    str | None,
    typer.Option(
        help="Keyframe to start from, name or number; 'none': the initial state "
        f"[default: {RELEASE!r}, or the only one of the model, if it has one]."
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Setting of the impact law, such as restitution=0.9; repeatable. Keys: "
        f"{', '.join(SETTINGS)}.",
    ),
]
GeomsOption = Annotated[
    str | None,
    typer.Option(
        "--geoms",
        metavar="NAME,...",
        help="Geoms whose impacts are ours [default: all that move and collide].",
    ),
]
MaterialOption = Annotated[
    list[str] | None,
    typer.Option(
        "--material",
        metavar="GEOM=NAME",
        help="Material of a geom, or of those of a pattern such as 'ball*'; "
        f"repeatable. Materials: {', '.join(MATERIALS)}.",
    ),
]
GapOption = Annotated[
    float | None,
    typer.Option("--gap", help="How early contacts are seen [m], instead of --speed."),
]
TimestepOption = Annotated[
    float | None,
    typer.Option("--timestep", help="Timestep [s], instead of that of the model."),
]
IntegratorOption = Annotated[
    str | None,
    typer.Option(
        "--integrator", help="Euler, RK4, implicit, implicitfast, as in MJCF."
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
