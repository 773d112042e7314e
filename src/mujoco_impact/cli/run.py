"""`mujoco-impact run`."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from mujoco_impact import tables
from mujoco_impact.cli.options import (
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
from mujoco_impact.cli.scenes import parsed_settings, scene_of, start_keyframe
from mujoco_impact.remarks import NO_IMPACT
from mujoco_impact.runner import run as run_model
from mujoco_impact.trajectory import Trajectory

IMPACTS_SHOWN = 12


def run(
    model: ModelArgument,
    duration: DurationOption = 3.0,
    keyframe: KeyframeOption = None,
    settings: SetOption = None,
    params: ParamsOption = None,
    friction: FrictionOption = False,
    speed: SpeedOption = None,
    every: Annotated[int, typer.Option(help="Steps between two samples.")] = 1,
    native: Annotated[
        bool, typer.Option("--native", help="Leave all contacts to MuJoCo.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Trajectory file (.npz) to write.")
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Simulate a model with our impacts and list them."""
    with clean_errors():
        options = parsed_settings(settings, params, friction=friction, speed=speed)
        spec = scene_of(model, options, native=native)
        begin = time.perf_counter()
        with progress(json_file) as report:
            trajectory = run_model(
                spec,
                duration=duration,
                keyframe=start_keyframe(spec, keyframe),
                every=every,
                progress=lambda fraction: report(f"{fraction:4.0%}"),
            )
        elapsed = time.perf_counter() - begin
        saved = None if out is None else trajectory.save(out)
        _show_run(spec.modelname, trajectory, elapsed, saved, json_file)
        exit_if_unsound(trajectory.remarks)


def _show_run(
    scene: str,
    trajectory: Trajectory,
    elapsed: float,
    saved: Path | None,
    json_file: str | None,
) -> None:
    """Prints what happened in a run and writes the JSON."""
    document: dict[str, Any] = {
        "scene": scene,
        "duration": float(trajectory.time[-1]),
        "timestep": trajectory.timestep,
        "integrator": trajectory.integrator,
        "mujoco_version": trajectory.mujoco_version,
        "elapsed": elapsed,
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
    console.print(tables.impact_table(trajectory.impacts, limit=IMPACTS_SHOWN))
    hidden = len(trajectory.impacts) - IMPACTS_SHOWN
    if hidden > 0:
        console.out(f"... and {hidden} more (--json lists all)")
    console.out(
        f"{scene}: {trajectory.time[-1]:g} s simulated in {elapsed:.3f} s, "
        f"{tables.energy_line(trajectory)}"
    )
    for remark in trajectory.remarks:
        # the others have been warned of
        if remark.kind == NO_IMPACT:
            console.out(remark.text)
    if saved is not None:
        console.out(f"trajectory: {saved}")
