"""`mujoco-impact compare` and `mujoco-impact demo`, a comparison of a set scene."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

import mujoco
import typer
from rich.table import Table

from mujoco_impact.cli import tables
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
from mujoco_impact.cli.report import (
    HtmlOption,
    VideoOption,
    check_report_options,
    command_line,
    video_of,
)
from mujoco_impact.cli.scenes import (
    geom_names,
    parsed_settings,
    read_scene,
    start_keyframe,
)
from mujoco_impact.comparing.compare import compare as compare_scene
from mujoco_impact.comparison import Comparison
from mujoco_impact.errors import ComparisonInterrupted, ImpactError
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.plot import plot_comparison
from mujoco_impact.scene import attach
from mujoco_impact.starts import Keyframe

DEMO_SIZE = (320, 280)
"""Size of each panel of the video of the demonstration [pixels]."""

PAIRS_SHOWN = 3
"""Pairs that passed through each other named at most."""


def demo(
    png: Annotated[Path, typer.Option(help="Picture to write.")] = Path(
        "mujoco_impact_demo.png"
    ),
    video: Annotated[
        Path, typer.Option(help="Video to write, where rendering works.")
    ] = Path("mujoco_impact_demo.mp4"),
    json_file: JsonOption = None,
) -> None:
    """Show what a row of five touching steel balls does, ours and MuJoCo's way."""
    with clean_errors():
        check_outputs(png, video, json_file)
        require_matplotlib()
        scene = read_scene("row_5")
        compared = _compared(scene, 3.0, None, {}, {}, json_file)
        _show_comparison(compared[0], png, json_file)
        _write_video(compared[0], video, json_file)
        _end(*compared)


def compare(
    context: typer.Context,
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
    html: HtmlOption = None,
    video: VideoOption = False,
    json_file: JsonOption = None,
) -> None:
    """Compare our impacts with MuJoCo's own contacts, accuracy and run time.

    MuJoCo's contacts run as the scene has them, and with their best settings for
    impacts: a damper that reverses speeds within a step, springs without damping
    (compliant), and springs that push as Hertz contacts do (Hertz-like; h/10: with a
    tenth of the timestep).
    """
    with clean_errors():
        check_outputs(png, json_file)
        check_report_options(html, video=video)
        if png is not None:
            require_matplotlib()
        scene = read_scene(model, timestep=timestep, integrator=integrator)
        start = start_keyframe(scene, keyframe)
        options: dict[str, Any] = {
            "geoms": geom_names(geoms),
            "gap": gap,
            "speed": speed,
        }
        law = parsed_settings(settings, params, friction=friction)
        compared = _compared(
            scene,
            duration,
            start,
            options,
            law,
            json_file,
        )
        stem = re.sub(r"[^\w.-]+", "_", scene.modelname)
        picture = png or Path(f"{stem}_comparison.png")
        _show_comparison(compared[0], picture, json_file)
        if html is not None:
            drawn = scene if owned_geoms(scene) else attach(scene, **options, **law)
            _write_report(context, compared[0], drawn, start, html, video=video)
            console_of(json_file).out(f"report: {html}")
        _end(*compared)


def _compared(
    scene: mujoco.MjSpec,
    duration: float,
    keyframe: Keyframe,
    options: dict[str, Any],
    settings: dict[str, Any],
    json_file: str | None,
) -> tuple[Comparison, ComparisonInterrupted | None]:
    """Returns the comparison, showing its progress, and what ended it early."""
    with progress(json_file) as report:
        try:
            comparison = compare_scene(
                scene,
                duration=duration,
                keyframe=keyframe,
                progress=report,
                settings=settings,
                **options,
            )
        except ComparisonInterrupted as stopped:
            return stopped.comparison, stopped
    return comparison, None


def _show_comparison(
    comparison: Comparison,
    png: Path,
    json_file: str | None,
) -> None:
    """Prints the tables, then writes the JSON and the picture."""
    console = console_of(json_file)
    first, second = _tables(comparison)
    console.print(first)
    more = len(comparison.bodies) - tables.MOST_BODIES
    if more > 0 and not comparison.reference_velocities:
        console.out(f"and {more} more bodies take part (--json has all)")
    console.print()
    console.print(second)
    for line in _notes(comparison):
        console.out(line)
    picture, trouble = None, ""
    try:
        picture = plot_comparison(comparison, png)
    except (ImpactError, OSError) as error:
        trouble = f"no picture: {error}"
    write_json(
        json_file,
        {**comparison.to_dict(), "picture": None if picture is None else str(picture)},
    )
    console.out(trouble or f"picture: {picture}")


def _end(comparison: Comparison, stopped: ComparisonInterrupted | None) -> None:
    """Ends the command as what was compared deserves."""
    if stopped is not None:
        raise stopped
    exit_if_unsound(comparison.remarks)


def _write_video(comparison: Comparison, file: Path, json_file: str | None) -> None:
    """Writes the video of the demonstration, or says why there is none."""
    from mujoco_impact.video import View, write_video
    from mujoco_impact.video.scenes import panels_of

    console = console_of(json_file)
    try:
        with progress(json_file) as report:
            write_video(
                comparison.model,
                panels_of(comparison),
                file,
                view=View(size=DEMO_SIZE),
                progress=lambda fraction: report(f"video {fraction:4.0%}"),
            )
    except (ImpactError, OSError) as error:
        console.out(f"no video: {error}")
    else:
        console.out(f"video: {file}")


def _write_report(
    context: typer.Context,
    comparison: Comparison,
    drawn: mujoco.MjSpec,
    start: Keyframe,
    html: Path,
    *,
    video: bool,
) -> None:
    """Writes the report of a comparison, with a video of the drawn scene if wanted."""
    from mujoco_impact.report import write_page
    from mujoco_impact.report.comparisons import comparison_page
    from mujoco_impact.video.scenes import panels_of

    panels = panels_of(comparison)
    with video_of(drawn, panels, start, wanted=video) as film:
        page = comparison_page(
            comparison,
            _tables(comparison),
            command=command_line(context),
            notes=[line for line in _notes(comparison) if line],
            video=film,
        )
        write_page(page, html)


def _tables(comparison: Comparison) -> list[Table]:
    """Returns the tables of a comparison."""
    velocities = tables.velocity_table if comparison.reference_velocities else None
    first = (velocities or tables.speed_table)(comparison)
    return [first, tables.comparison_table(comparison)]


def _notes(comparison: Comparison) -> list[str]:
    """Returns what is to say below the tables."""
    lines = [
        f"{method.name} failed: {method.failure}"
        for method in comparison.methods
        if method.failure
    ]
    for method in comparison.methods:
        pairs = () if method.seen is None else method.seen.passed
        if pairs:
            shown = ", ".join(" and ".join(pair) for pair in pairs[:PAIRS_SHOWN])
            more = ", ..." if len(pairs) > PAIRS_SHOWN else ""
            lines.append(
                f"{method.name}: {shown}{more} sank into each other past the middle"
            )
    missed = [
        method.name
        for method in comparison.methods
        if method.before is None and not method.failure
    ]
    if missed:
        lines.append(f"{', '.join(missed)}: the first impact does not happen")
    lines.append("")
    lines += [comparison.headline()] if comparison.headline() else []
    lines += [comparison.note] if comparison.note else []
    lines.append(
        f"first impact at {max(0.0, comparison.first.time):.4g} s with "
        f"v0 = {comparison.impact_speed:.4f} m/s; impacts slower than "
        f"{comparison.slowest:.2g} m/s are not counted; energy lost in impacts, to "
        f"restitution and friction, is in parts of all energy of motion, "
        f"{comparison.energy_scale:.3g} J"
    )
    return lines
