"""The command `mujoco-impact`: demo, run, compare, doctor."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any

import mujoco
import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn

import cradle_models
from mujoco_impact import tables
from mujoco_impact.compare import compare as compare_scene
from mujoco_impact.comparison import Comparison
from mujoco_impact.doctor import diagnose
from mujoco_impact.errors import ConfigError, ImpactError, SceneError
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.plot import plot_comparison
from mujoco_impact.runner import run as run_model
from mujoco_impact.scene import attach
from mujoco_impact.source import read_spec
from mujoco_impact.trajectory import Trajectory

START_KEYFRAME = "release"
"""Keyframe that a run starts from if the model has it and no other is asked for."""

IMPACTS_SHOWN = 12

USER_ERROR = 2
"""Exit code when the input or the installation is to blame."""

app = typer.Typer(
    name="mujoco-impact",
    help="Impacts by artificial impulse waveforms in MuJoCo.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    # the default mode would take units in brackets for markup
    rich_markup_mode="markdown",
)

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
JsonOption = Annotated[
    str | None,
    typer.Option("--json", metavar="FILE", help="Write JSON; '-' is standard output."),
]


@app.command()
def demo(
    png: Annotated[Path, typer.Option(help="Picture to write.")] = Path(
        "mujoco_impact_demo.png"
    ),
    json_file: JsonOption = None,
) -> None:
    """Show what a row of five touching steel balls does, ours and MuJoCo's way."""
    with _clean_errors():
        path = cradle_models.model_path("row_5")
        comparison = _compared(path, 3.0, START_KEYFRAME, {}, json_file)
        _show_comparison(comparison, png, json_file)


@app.command()
def run(
    model: ModelArgument,
    duration: DurationOption = 3.0,
    keyframe: KeyframeOption = None,
    settings: SetOption = None,
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
    with _clean_errors():
        spec = _scene(model, _parsed(settings), native=native)
        begin = time.perf_counter()
        with _progress(json_file) as report:
            trajectory = run_model(
                spec,
                duration=duration,
                keyframe=_start(spec, keyframe),
                every=every,
                progress=lambda fraction: report(f"{fraction:4.0%}"),
            )
        elapsed = time.perf_counter() - begin
        saved = None if out is None else trajectory.save(out)
        _show_run(spec.modelname, trajectory, elapsed, saved, json_file)


@app.command()
def compare(
    model: ModelArgument,
    duration: DurationOption = 3.0,
    keyframe: KeyframeOption = None,
    settings: SetOption = None,
    png: Annotated[
        Path | None, typer.Option(help="Picture to write [default: MODEL.png].")
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Compare our impacts with MuJoCo's own contacts, accuracy and run time."""
    with _clean_errors():
        path = _model_path(model)
        start = _start(read_spec(path), keyframe)
        comparison = _compared(path, duration, start, _parsed(settings), json_file)
        picture = png or Path(f"{path.stem}_comparison.png")
        _show_comparison(comparison, picture, json_file)


@app.command()
def bench(
    out: Annotated[
        Path, typer.Option(help="Folder for results.csv, results.json and charts.")
    ] = Path("benchmarks"),
    scenes: Annotated[
        str | None, typer.Option(help="Scenes, separated by commas [default: all].")
    ] = None,
    methods: Annotated[
        str | None, typer.Option(help="Methods, separated by commas [default: all].")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Only the recommended settings.")
    ] = False,
    steps: Annotated[bool, typer.Option(help="Time single steps, too.")] = True,
    json_file: JsonOption = None,
) -> None:
    """Measure run time against error for many methods, and draw the charts."""
    from mujoco_impact import bench as benchmark

    with _clean_errors():
        with _progress(json_file) as report:
            results = benchmark.run_benchmark(
                scenes=None if scenes is None else scenes.split(","),
                methods=None if methods is None else methods.split(","),
                quick=quick,
                steps=steps,
                progress=report,
            )
        files = benchmark.write_files(results, out)
        _write_json(json_file, results.to_dict())
        benchmark.show(results, _console(json_file))
        _console(json_file).out(f"\n{len(files)} files in {out}")


@app.command()
def doctor(json_file: JsonOption = None) -> None:
    """Check the installation and the answers of the plugin."""
    with _clean_errors():
        checks = diagnose()
        healthy = all(check.passed for check in checks)
        document = {
            "healthy": healthy,
            "checks": [dataclasses.asdict(check) for check in checks],
        }
        _write_json(json_file, document)
        console = _console(json_file)
        console.print(tables.check_table(checks))
        if not healthy:
            raise typer.Exit(USER_ERROR)
        console.out("everything works")


def main() -> None:
    """Runs the command line; the target of the console script."""
    app()


@contextlib.contextmanager
def _clean_errors() -> Iterator[None]:
    """Turns expected errors into one sentence on standard error and exit code 2."""
    try:
        yield
    except (ImpactError, cradle_models.CradleModelError, ValueError, OSError) as error:
        typer.echo(f"mujoco-impact: {' '.join(str(error).split())}", err=True)
        raise typer.Exit(USER_ERROR) from error


def _console(json_file: str | None) -> Console:
    """Returns where people read: standard error if standard output is JSON."""
    # no markup: headings and names may hold brackets
    return Console(stderr=json_file == "-", highlight=False, markup=False)


@contextlib.contextmanager
def _progress(json_file: str | None) -> Iterator[Callable[[str], None]]:
    """Shows what is going on, on a terminal only; yields a function to tell it."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"))
    console = Console(stderr=True)
    hidden = not console.is_terminal or json_file == "-"
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("starting")
        yield lambda text: bar.update(task, description=text)


def _model_path(model: str) -> Path:
    """Returns the file of a model given by path or by shipped name."""
    path = Path(model)
    if path.is_file():
        return path
    if model in cradle_models.list_models():
        return cradle_models.model_path(model)
    msg = (
        f"there is no model file {model!r} and no shipped model of that name "
        f"(available: {', '.join(cradle_models.list_models())})"
    )
    raise SceneError(msg)


def _scene(model: str, settings: dict[str, Any], *, native: bool) -> mujoco.MjSpec:
    """Returns the scene to run; one that has the plugin already stays as it is."""
    spec = read_spec(_model_path(model))
    present = owned_geoms(spec)
    if settings and (present or native):
        reason = "it runs with --native" if native else "it has the plugin already"
        msg = f"--set has no effect on {model!r}: {reason}"
        raise ConfigError(msg)
    if native or present:
        return spec
    return attach(spec, **settings)


def _parsed(settings: list[str] | None) -> dict[str, Any]:
    """Returns the settings given as KEY=VALUE."""
    parsed: dict[str, Any] = {}
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not (key and equals and value):
            msg = f"--set {setting!r}: must be KEY=VALUE, such as restitution=0.9"
            raise ConfigError(msg)
        parsed[key.strip()] = value.strip()
    return parsed


def _start(spec: mujoco.MjSpec, keyframe: str | None) -> str | int | None:
    """Returns the keyframe to start from."""
    names = [key.name for key in spec.keys]
    if keyframe is None:
        return START_KEYFRAME if START_KEYFRAME in names else None
    if keyframe in names:
        return keyframe
    if keyframe == "none":
        return None
    return int(keyframe) if keyframe.isdecimal() else keyframe


def _compared(
    path: Path,
    duration: float,
    keyframe: str | int | None,
    settings: dict[str, Any],
    json_file: str | None,
) -> Comparison:
    """Returns the comparison, showing its progress."""
    with _progress(json_file) as report:
        return compare_scene(
            path,
            duration=duration,
            keyframe=keyframe,
            progress=report,
            settings=settings,
        )


def _show_comparison(comparison: Comparison, png: Path, json_file: str | None) -> None:
    """Prints the tables and writes the picture and the JSON."""
    picture = plot_comparison(comparison, png)
    _write_json(json_file, {**comparison.to_dict(), "picture": str(picture)})
    console = _console(json_file)
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
        "trajectory": None if saved is None else str(saved),
    }
    _write_json(json_file, document)
    console = _console(json_file)
    console.print(tables.impact_table(trajectory.impacts, limit=IMPACTS_SHOWN))
    hidden = len(trajectory.impacts) - IMPACTS_SHOWN
    if hidden > 0:
        console.out(f"... and {hidden} more (--json lists all)")
    console.out(
        f"{scene}: {trajectory.time[-1]:g} s simulated in {elapsed:.3f} s, "
        f"{tables.energy_line(trajectory)}"
    )
    if saved is not None:
        console.out(f"trajectory: {saved}")


def _write_json(json_file: str | None, document: dict[str, Any]) -> None:
    """Writes a document to a file, or to standard output for "-"."""
    if json_file is None:
        return
    text = json.dumps(document, indent=2, allow_nan=False) + "\n"
    if json_file == "-":
        sys.stdout.write(text)
    else:
        Path(json_file).write_text(text, encoding="utf-8")
