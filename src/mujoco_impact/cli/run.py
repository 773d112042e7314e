"""`mujoco-impact run`."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path
from typing import Annotated, Any

import mujoco
import typer

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
    shown_settings,
    video_of,
)
from mujoco_impact.cli.scenes import (
    geom_names,
    parsed_settings,
    scene_of,
    start_keyframe,
)
from mujoco_impact.errors import RunInterrupted, SimulationError
from mujoco_impact.impact import check_impact_file, write_impacts
from mujoco_impact.impact_list import listed
from mujoco_impact.remarks import NO_IMPACT
from mujoco_impact.runner import run as run_model
from mujoco_impact.specifications import compile_spec
from mujoco_impact.starts import Keyframe
from mujoco_impact.trajectory import Trajectory
from mujoco_impact.video.motion import Panel

IMPACTS_SHOWN = 12


def run(
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
    every: Annotated[int, typer.Option(help="Steps between two samples.")] = 1,
    native: Annotated[
        bool, typer.Option("--native", help="Leave all contacts to MuJoCo.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Trajectory file (.npz) to write.")
    ] = None,
    impacts: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Table of all impacts to write, .csv or .parquet."
        ),
    ] = None,
    html: HtmlOption = None,
    video: VideoOption = False,
    json_file: JsonOption = None,
) -> None:
    """Simulate a model with our impacts and list them.

    Ctrl-C ends the run early and keeps what was computed.
    """
    with clean_errors():
        check_outputs(out, json_file)
        check_report_options(html, video=video)
        if impacts is not None:
            check_impact_file(impacts)
        options = parsed_settings(
            settings,
            params,
            friction=friction,
            geoms=geom_names(geoms),
            gap=gap,
            speed=speed,
        )
        spec = scene_of(
            model, options, native=native, timestep=timestep, integrator=integrator
        )
        start = start_keyframe(spec, keyframe)
        begin = time.perf_counter()
        trajectory, ended = _simulated(spec, duration, start, every, json_file)
        elapsed = time.perf_counter() - begin
        saved = None if out is None else trajectory.save(out)
        if impacts is not None:
            write_impacts(trajectory.impacts, impacts)
        _show_run(spec.modelname, trajectory, elapsed, saved, ended, json_file)
        if impacts is not None:
            console_of(json_file).out(f"impacts: {impacts}")
        if html is not None:
            _write_report(context, spec, trajectory, start, options, html, video=video)
            console_of(json_file).out(f"report: {html}")
        if ended is not None:
            raise ended
        exit_if_unsound(trajectory.remarks)


def _write_report(
    context: typer.Context,
    spec: mujoco.MjSpec,
    trajectory: Trajectory,
    start: Keyframe,
    options: dict[str, Any],
    html: Path,
    *,
    video: bool,
) -> None:
    """Writes the report of a run."""
    from mujoco_impact.report import write_page
    from mujoco_impact.report.runs import run_page

    panels = [Panel.of(trajectory, "")]
    with video_of(spec, panels, start, wanted=video) as film:
        page = run_page(
            compile_spec(spec),
            trajectory,
            scene=spec.modelname,
            command=command_line(context),
            settings=shown_settings(options),
            video=film,
        )
        write_page(page, html)


def _simulated(
    spec: mujoco.MjSpec,
    duration: float,
    start: Keyframe,
    every: int,
    json_file: str | None,
) -> tuple[Trajectory, SimulationError | RunInterrupted | None]:
    """Returns the motion, and what ended it before its time."""
    with progress(json_file) as report:
        try:
            trajectory = run_model(
                spec,
                duration=duration,
                keyframe=start,
                every=every,
                progress=lambda fraction: report(f"{fraction:4.0%}"),
            )
        except SimulationError as error:
            if error.trajectory is None:
                raise
            return error.trajectory, error
        except RunInterrupted as stopped:
            return stopped.trajectory, stopped
    return trajectory, None


def _show_run(
    scene: str,
    trajectory: Trajectory,
    elapsed: float,
    saved: Path | None,
    ended: BaseException | None,
    json_file: str | None,
) -> None:
    """Prints what happened in a run and writes the JSON."""
    document: dict[str, Any] = {
        "scene": scene,
        "start": trajectory.start,
        "duration": float(trajectory.time[-1]),
        "timestep": trajectory.timestep,
        "integrator": trajectory.integrator,
        "mujoco_version": trajectory.mujoco_version,
        "elapsed": elapsed,
        "ended": None if ended is None else str(ended),
        "energy": trajectory.total_energy[[0, -1]].tolist(),
        "qpos": trajectory.qpos[-1].tolist(),
        "qvel": trajectory.qvel[-1].tolist(),
        "impacts": [dataclasses.asdict(impact) for impact in trajectory.impacts],
        "missed_impacts": trajectory.missed_impacts,
        "remarks": [dataclasses.asdict(remark) for remark in trajectory.remarks],
        "trajectory": None if saved is None else str(saved),
    }
    write_json(json_file, document)
    console = console_of(json_file)
    meetings, bounces = listed(
        trajectory.impacts,
        timestep=trajectory.timestep,
        end=float(trajectory.time[-1]),
    )
    if meetings:
        console.print(tables.impact_table(meetings, limit=IMPACTS_SHOWN))
    hidden = len(meetings) - IMPACTS_SHOWN
    if hidden > 0:
        console.out(f"... and {hidden} more (--impacts FILE.csv has all)")
    for one in bounces:
        console.out(str(one))
    console.out(
        f"{scene}, from {trajectory.start}: {trajectory.time[-1]:g} s simulated in "
        f"{elapsed:.3f} s, {tables.energy_line(trajectory)}"
    )
    for remark in trajectory.remarks:
        # the others have been warned of
        if remark.kind == NO_IMPACT:
            console.out(remark.text)
    if ended is not None:
        console.out(f"the run ended early: {len(trajectory.time)} samples are kept")
    if saved is not None:
        console.out(f"trajectory: {saved}")
