"""The command `mujoco-impact`: one file per command."""

from __future__ import annotations

import typer

from mujoco_impact.cli.bench import bench
from mujoco_impact.cli.calibrate import calibrate, shots
from mujoco_impact.cli.compare import compare, demo
from mujoco_impact.cli.doctor import doctor
from mujoco_impact.cli.paper import force_sensor, paper
from mujoco_impact.cli.run import run
from mujoco_impact.cli.stress import stress
from mujoco_impact.cli.video import video

app = typer.Typer(
    name="mujoco-impact",
    help="Impacts by artificial impulse waveforms in MuJoCo.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    # the default mode would take units in brackets for markup
    rich_markup_mode="markdown",
)

for command in (
    demo,
    run,
    compare,
    video,
    calibrate,
    shots,
    paper,
    force_sensor,
    bench,
    stress,
    doctor,
):
    app.command()(command)


def main() -> None:
    """Runs the command line; the target of the console script."""
    app()
