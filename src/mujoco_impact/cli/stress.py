"""`mujoco-impact stress`."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated

import typer

from mujoco_impact.cli.options import (
    JsonOption,
    KeyframeOption,
    SetOption,
    SpeedOption,
    complete_model,
)
from mujoco_impact.cli.output import (
    UNSOUND,
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
    shown_settings,
)
from mujoco_impact.cli.scenes import parsed_settings, read_scene, start_keyframe
from mujoco_impact.errors import ConfigError
from mujoco_impact.files import write_text
from mujoco_impact.starts import start_told


def stress(
    context: typer.Context,
    # not required: what is missing is told in a sentence
    model: Annotated[
        str | None,
        typer.Argument(
            metavar="MODEL",
            help="Model file, name of a shipped model, or '-' for standard input.",
            autocompletion=complete_model,
        ),
    ] = None,
    duration: Annotated[
        float, typer.Option(help="Simulated time of each run [s].")
    ] = 1.0,
    keyframe: KeyframeOption = None,
    settings: SetOption = None,
    speed: SpeedOption = None,
    out: Annotated[
        Path | None, typer.Option(help="Report to write (markdown).")
    ] = None,
    html: HtmlOption = None,
    json_file: JsonOption = None,
) -> None:
    """Look for where a scene of yours stops being sound."""
    from mujoco_impact.stress.findings import (
        StressInterrupted,
        findings_table,
        stress_scene,
    )

    with clean_errors():
        if model is None:
            msg = (
                "MODEL is missing: give a scene of yours, such as "
                "`mujoco-impact stress scene.xml`; random scenes are run by "
                "`scripts/stress` in a clone of the project"
            )
            raise ConfigError(msg)
        check_outputs(out, json_file)
        check_report_options(html)
        law = parsed_settings(settings, speed=speed)
        scene = read_scene(model)
        start = start_keyframe(scene, keyframe)
        stopped = None
        with progress(json_file) as tell:
            try:
                findings = stress_scene(
                    scene,
                    duration=duration,
                    keyframe=start,
                    settings=law,
                    progress=tell,
                )
            except StressInterrupted as interrupted:
                findings, stopped = interrupted.findings, interrupted
        console = console_of(json_file)
        text = findings_table(findings)
        if out is not None:
            write_text(out, f"# Stress report of {scene.modelname}\n\n{text}")
            console.out(f"report: {out}")
        else:
            console.out(text)
        if html is not None:
            from mujoco_impact.report import write_page
            from mujoco_impact.report.stress import scene_page

            facts = {
                "start": start_told([key.name for key in scene.keys], start),
                "duration": f"{duration:g} s each",
                "settings": shown_settings(law),
            }
            page = scene_page(
                findings,
                scene=scene.modelname,
                command=command_line(context),
                facts=facts,
            )
            write_page(page, html)
        write_json(json_file, {"findings": [dataclasses.asdict(f) for f in findings]})
        if stopped is not None:
            raise stopped
        # what other timesteps and speeds do is for the user to weigh
        if findings[0].problems:
            raise typer.Exit(UNSOUND)
