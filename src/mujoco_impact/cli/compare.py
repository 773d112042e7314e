"""`mujoco-impact compare` and `mujoco-impact demo`, a comparison of a set scene."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

import cradle_models
from mujoco_impact import tables
from mujoco_impact.cli.options import (
    START_KEYFRAME,
    DurationOption,
    FrictionOption,
    JsonOption,
    KeyframeOption,
    ModelArgument,
    ParamsOption,
    SetOption,
    SpeedOption,
)
from mujoco_impact.cli.output import (
    clean_errors,
    console_of,
    exit_if_unsound,
    progress,
    write_json,
)
from mujoco_impact.cli.scenes import model_path, parsed_settings, start_keyframe
from mujoco_impact.compare import compare as compare_scene
from mujoco_impact.comparison import Comparison
from mujoco_impact.plot import plot_comparison
from mujoco_impact.source import read_spec


def demo(
    png: Annotated[Path, typer.Option(help="Picture to write.")] = Path(
        "mujoco_impact_demo.png"
    ),
    json_file: JsonOption = None,
) -> None:
    """Show what a row of five touching steel balls does, ours and MuJoCo's way."""
    with clean_errors():
        path = cradle_models.model_path("row_5")
        comparison = _compared(path, 3.0, START_KEYFRAME, {}, None, json_file)
        _show_comparison(comparison, png, json_file)


def compare(
    model: ModelArgument,
    duration: DurationOption = 3.0,
    keyframe: KeyframeOption = None,
    settings: SetOption = None,
    params: ParamsOption = None,
    friction: FrictionOption = False,
    speed: SpeedOption = None,
    png: Annotated[
        Path | None, typer.Option(help="Picture to write [default: MODEL.png].")
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Compare our impacts with MuJoCo's own contacts, accuracy and run time."""
    with clean_errors():
        path = model_path(model)
        start = start_keyframe(read_spec(path), keyframe)
        comparison = _compared(
            path,
            duration,
            start,
            parsed_settings(settings, params, friction=friction),
            speed,
            json_file,
        )
        picture = png or Path(f"{path.stem}_comparison.png")
        _show_comparison(comparison, picture, json_file)


def _compared(
    path: Path,
    duration: float,
    keyframe: str | int | None,
    settings: dict[str, Any],
    speed: float | None,
    json_file: str | None,
) -> Comparison:
    """Returns the comparison, showing its progress."""
    with progress(json_file) as report:
        return compare_scene(
            path,
            duration=duration,
            keyframe=keyframe,
            progress=report,
            speed=speed,
            settings=settings,
        )


def _show_comparison(comparison: Comparison, png: Path, json_file: str | None) -> None:
    """Prints the tables and writes the picture and the JSON."""
    picture = plot_comparison(comparison, png)
    write_json(json_file, {**comparison.to_dict(), "picture": str(picture)})
    console = console_of(json_file)
    if comparison.reference_velocities:
        console.print(tables.velocity_table(comparison))
        console.print()
    console.print(tables.comparison_table(comparison))
    for method in comparison.methods:
        if method.failure:
            console.out(f"{method.name} failed: {method.failure}")
    if comparison.note:
        console.out(comparison.note)
    console.out(f"\nimpact speed v0 = {comparison.impact_speed:.4f} m/s")
    console.out(f"picture: {picture}")
    exit_if_unsound(comparison.remarks)
