"""The command `mujoco-impact`: one file per command."""

from __future__ import annotations

from collections.abc import Callable
from importlib import metadata
from typing import Annotated, Any

import typer

from mujoco_impact.cli.attach import attach
from mujoco_impact.cli.calibrate import calibrate, shots
from mujoco_impact.cli.compare import compare, demo
from mujoco_impact.cli.doctor import doctor
from mujoco_impact.cli.paper import force_sensor, paper
from mujoco_impact.cli.run import run
from mujoco_impact.cli.stress import stress
from mujoco_impact.cli.sweep import sweep
from mujoco_impact.cli.video import video
from mujoco_impact.cli.view import view

app = typer.Typer(
    name="mujoco-impact",
    help="Impacts of MuJoCo scenes, computed as force pulses of finite duration.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    # the default mode would take units in brackets for markup
    rich_markup_mode="markdown",
)

COMMANDS: tuple[tuple[Callable[..., Any], str, str], ...] = (
    (demo, "demo", "demo --png picture.png"),
    (
        run,
        "run row_5 --duration 1",
        "run scene.xml --set restitution=0.9 --impacts table.csv",
    ),
    (compare, "compare row_3", "compare scene.xml --keyframe shot --png picture.png"),
    (
        attach,
        "attach scene.xml -o with_impacts.xml",
        "attach scene.xml --geoms ball --set restitution=0.8 -o with_impacts.xml",
    ),
    (
        video,
        "video row_5 --compare --out cradle.mp4",
        "video scene.xml --keyframe shot --out scene.gif",
    ),
    (view, "view row_5", "view scene.xml --keyframe shot --set restitution=0.8"),
    (calibrate, "calibrate shots.csv", "calibrate shots.csv --fix e=1 --out p.json"),
    (shots, "shots AAB", "shots ABA --count 20 --error 0 --out shots.csv"),
    (paper, "paper", "paper --out tables.md"),
    (force_sensor, "force-sensor", "force-sensor --out figures"),
    (
        stress,
        "stress scene.xml --keyframe shot",
        "stress row_5 --duration 0.5 --out report.md",
    ),
    (
        sweep,
        "sweep sweep.toml --plot sweep.png",
        "sweep sweep.toml --out rows.parquet --scheduler tcp://10.0.0.1:8786",
    ),
    (doctor, "doctor", "doctor --json -"),
)
"""Each command, and two examples that its help ends with."""

for command, *examples in COMMANDS:
    lines = "\n\n".join(f"`mujoco-impact {example}`" for example in examples)
    app.command(epilog=f"Examples:\n\n{lines}")(command)


def _show_version(asked: bool) -> None:
    """Prints the versions and ends the command."""
    if asked:
        ours = metadata.version("mujoco-impact")
        typer.echo(f"mujoco-impact {ours}, MuJoCo {metadata.version('mujoco')}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            help="Show the versions and exit.",
            callback=_show_version,
            is_eager=True,
        ),
    ] = False,
) -> None:
    """Impacts of MuJoCo scenes, computed as force pulses of finite duration."""


def main() -> None:
    """Runs the command line; the target of the console script."""
    app()
