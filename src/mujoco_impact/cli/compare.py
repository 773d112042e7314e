"""`mujoco-impact compare` and `mujoco-impact demo`, a comparison of a set scene."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import mujoco
import typer

from mujoco_impact import tables
from mujoco_impact.cli.options import (
    DurationOption,
    FrictionOption,
    GapOption,
    GeomsOption,
    IntegratorOption,
    JsonOption,
    KeyframeOption,
    ModelArgument,
    ParamsOption,
    SetOption,
    SpeedOption,
    TimestepOption,
)
from mujoco_impact.cli.output import (
    check_outputs,
    clean_errors,
    console_of,
    exit_if_unsound,
    progress,
    write_json,
)
from mujoco_impact.cli.scenes import (
    geom_names,
    parsed_settings,
    read_scene,
    start_keyframe,
)
from mujoco_impact.compare import compare as compare_scene
from mujoco_impact.comparison import Comparison
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.plot import plot_comparison
from mujoco_impact.starts import Keyframe


def demo(
    png: Annotated[Path, typer.Option(help="Picture to write.")] = Path(
        "mujoco_impact_demo.png"
    ),
    json_file: JsonOption = None,
) -> None:
    """Show what a row of five touching steel balls does, ours and MuJoCo's way."""
    with clean_errors():
        check_outputs(png, json_file)
        require_matplotlib()
        scene = read_scene("row_5")
        comparison = _compared(scene, 3.0, None, {}, {}, json_file)
        _show_comparison(comparison, png, json_file)


def compare(
    model: ModelArgument,
    duration: DurationOption = 3.0,
    keyframe: KeyframeOption = None,
    settings: SetOption = None,
    params: ParamsOption = None,
    friction: FrictionOption = False,
    geoms: GeomsOption = None,
    gap: GapOption = None,
    speed: SpeedOption = None,
    timestep: TimestepOption = None,
    integrator: IntegratorOption = None,
    png: Annotated[
        Path | None, typer.Option(help="Picture to write [default: MODEL.png].")
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Compare our impacts with MuJoCo's own contacts, accuracy and run time."""
    with clean_errors():
        check_outputs(png, json_file)
        if png is not None:
            require_matplotlib()
        scene = read_scene(model, timestep=timestep, integrator=integrator)
        comparison = _compared(
            scene,
            duration,
            start_keyframe(scene, keyframe),
            {"geoms": geom_names(geoms), "gap": gap, "speed": speed},
            parsed_settings(settings, params, friction=friction),
            json_file,
        )
        picture = png or Path(f"{scene.modelname}_comparison.png")
        _show_comparison(comparison, picture, json_file)


def _compared(
    scene: mujoco.MjSpec,
    duration: float,
    keyframe: Keyframe,
    options: dict[str, Any],
    settings: dict[str, Any],
    json_file: str | None,
) -> Comparison:
    """Returns the comparison, showing its progress."""
    with progress(json_file) as report:
        return compare_scene(
            scene,
            duration=duration,
            keyframe=keyframe,
            progress=report,
            settings=settings,
            **options,
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
