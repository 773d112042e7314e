"""Commands keep what they computed, and say beforehand what they could not write."""

from __future__ import annotations

import csv
import json
import os
import sys
from pathlib import Path
from typing import Any

import mujoco
import pytest
from typer.testing import CliRunner, Result

import mujoco_impact.cli
from mujoco_impact import Trajectory, run
from mujoco_impact.cli import COMMANDS, app

STIFF = """<mujoco model="stiff"><option timestep=".01" gravity="0 0 0"/>
  <worldbody><body><joint name="x" type="slide" stiffness="1e9"/><geom size=".1"/>
  </body></worldbody><keyframe><key name="bent" qpos=".1"/></keyframe></mujoco>"""


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs each command in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


def command(*arguments: str, **options: Any) -> Result:
    """Returns the outcome of a command line."""
    return CliRunner().invoke(
        app, list(arguments), prog_name="mujoco-impact", **options
    )


def test_impacts_go_to_a_table(two_balls: str) -> None:
    """CSV needs nothing; the file is named in what is printed."""
    Path("scene.xml").write_text(two_balls)
    done = command(*("run", "scene.xml", "--duration", ".02", "--impacts", "all.csv"))
    assert done.exit_code == 0, done.output
    assert "impacts: all.csv" in done.stdout
    with Path("all.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert float(row["closing_speed"]) == pytest.approx(1.0)
    assert row["normal_x"] in ("1.0", "-1.0")
    wrong = command("run", "scene.xml", "--impacts", "all.txt")
    assert wrong.exit_code == 2
    assert "end in .csv or .parquet" in wrong.stderr


def test_impacts_go_to_parquet(two_balls: str) -> None:
    """With pyarrow, if it is there."""
    parquet = pytest.importorskip("pyarrow.parquet")
    Path("scene.xml").write_text(two_balls)
    done = command(*("run", "scene.xml", "--duration", ".02", "--impacts", "a.parquet"))
    assert done.exit_code == 0, done.output
    assert parquet.read_table("a.parquet").num_rows == 1


def test_a_run_that_diverges_keeps_what_came_before() -> None:
    """Trajectory and JSON are written, and the reason told; exit code 2."""
    Path("stiff.xml").write_text(STIFF)
    done = command(
        *("run", "stiff.xml", "--native", "--out", "kept", "--json", "run.json")
    )
    assert done.exit_code == 2
    assert "MuJoCo gave a warning in the step at" in done.stderr
    kept = Trajectory.load("kept.npz")
    assert f"{len(kept.time)} samples are kept" in done.stdout
    document = json.loads(Path("run.json").read_text())
    assert "unstable" in document["ended"]
    assert document["duration"] == pytest.approx(kept.time[-1])


def test_control_c_keeps_what_came_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit code 130, as shells expect."""

    def run_and_stop(*arguments: Any, **options: Any) -> Trajectory:
        def stop(_: mujoco.MjModel, data: mujoco.MjData) -> None:
            if data.time > 0.3:
                raise KeyboardInterrupt

        return run(*arguments, **options, controller=stop)

    module = sys.modules["mujoco_impact.cli.run"]
    monkeypatch.setattr(module, "run_model", run_and_stop)
    done = command("run", "row_3", "--out", "kept.npz")
    assert done.exit_code == 130
    assert "interrupted at 0.3 s" in done.stderr
    assert "ball_1 - ball_2" in done.stdout
    assert len(Trajectory.load("kept.npz").impacts) == 2


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "row_3", "--out", "no/such/run.npz"),
        ("run", "row_3", "--json", "no/such/run.json"),
        ("run", "row_3", "--impacts", "no/such/run.csv"),
        ("compare", "row_3", "--png", "no/such/picture.png"),
        ("stress", "row_3", "--out", "no/such/report.md"),
        ("attach", "row_3", "-o", "no/such/scene.xml"),
        ("calibrate", "shots.csv", "--out", "no/such/p.json"),
        ("shots", "AAB", "--out", "no/such/shots.csv"),
        ("demo", "--png", "no/such/picture.png"),
        ("paper", "--out", "no/such/tables.md"),
    ],
)
def test_what_cannot_be_written_is_told_before_anything_is_computed(
    arguments: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the file's name; no step is taken."""
    monkeypatch.setattr(mujoco, "mj_step", None)
    done = command(*arguments)
    assert done.exit_code == 2
    assert "No such file or directory: 'no/such/" in done.stderr
    assert "Traceback" not in done.output


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_no_permission_is_told_before_anything_is_computed() -> None:
    """As a sentence."""
    Path("closed").mkdir(mode=0o500)
    done = command("run", "row_3", "--out", "closed/run.npz")
    assert done.exit_code == 2
    assert "Permission denied" in done.stderr


def test_a_model_comes_from_standard_input_and_options_change_it(
    two_balls: str,
) -> None:
    """Timestep and integrator of the command line are those of the run."""
    done = command(
        *("run", "-", "--duration", "0.02", "--timestep", "0.001"),
        *("--integrator", "rk4", "--geoms", "left", "--gap", "0.01", "--json", "-"),
        input=two_balls,
    )
    assert done.exit_code == 0, done.output
    document = json.loads(done.stdout)
    assert (document["timestep"], document["integrator"]) == (0.001, "RK4")
    assert document["start"] == "keyframe 'shot'"
    assert document["qvel"] == pytest.approx([0.0, 1.0], abs=1e-5)
    wrong = command("run", "row_3", "--integrator", "RK5")
    assert "no integrator 'RK5'; did you mean 'RK4'" in wrong.stderr


def test_attach_writes_a_scene_that_runs(two_balls: str) -> None:
    """The file has the plugin and its settings; without -o it is printed."""
    Path("in.xml").write_text(two_balls)
    done = command("attach", "in.xml", "-o", "out.xml", "--set", "restitution=0.5")
    assert done.exit_code == 0, done.output
    assert "the impacts of left, right are ours" in done.stdout
    ran = command("run", "out.xml", "--duration", "0.02", "--json", "-")
    assert json.loads(ran.stdout)["qvel"] == pytest.approx([0.25, 0.75], abs=1e-5)
    assert command("attach", "in.xml").stdout.startswith("<mujoco")


@pytest.mark.parametrize("row", COMMANDS, ids=lambda row: row[0].__name__)
def test_help_ends_with_two_examples(row: tuple[Any, ...]) -> None:
    """Of the command itself."""
    name = row[0].__name__.replace("_", "-")
    done = command(name, "--help")
    assert done.exit_code == 0
    end = done.stdout.partition("Examples:")[2]
    assert end.count(f"mujoco-impact {name}") == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "run"),
        (("run",), "Missing argument 'MODEL'"),
        (("compare",), "Missing argument 'MODEL'"),
        (("attach",), "Missing argument 'MODEL'"),
        (("calibrate",), "Missing argument 'DATA.csv'"),
        (("shots",), "Missing argument"),
        (("run", "text.xml"), "text.xml: it is no MJCF or URDF, for line 1 is not"),
        (("run", "row_3", "--geoms", "ball_9"), "no geom 'ball_9'; did you mean"),
        (("run", "row_3", "--duration", "0"), "duration = 0.0: must be a time > 0"),
        (("run", "still.xml"), "no body of the scene that can move has a geom"),
        (("compare", "still.xml"), "no body of the scene that can move has a geom"),
        (("stress", "missing.xml"), "no model file 'missing.xml'"),
    ],
)
def test_what_a_newcomer_gets_wrong_is_told_in_words(
    arguments: tuple[str, ...], words: str
) -> None:
    """Exit code 2 and no traceback."""
    Path("text.xml").write_text("hello")
    Path("still.xml").write_text(
        '<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>'
    )
    done = command(*arguments)
    assert done.exit_code == 2
    assert words in " ".join(done.output.replace("│", " ").split())
    assert "Traceback" not in done.output


def test_shells_complete_models_and_options() -> None:
    """Shipped names, files and folders."""
    Path("rows").mkdir()
    Path("row.xml").write_text("")
    done = command(
        env={
            "_MUJOCO_IMPACT_COMPLETE": "complete_bash",
            "COMP_WORDS": "mujoco-impact run ro",
            "COMP_CWORD": "2",
        }
    )
    offered = done.stdout.split()
    assert {"row_3", "row.xml", "rows/"} <= set(offered)
    assert mujoco_impact.cli.app.registered_commands


def test_the_version_is_told() -> None:
    """That of MuJoCo, too."""
    done = command("--version")
    assert done.exit_code == 0
    assert f"MuJoCo {mujoco.mj_versionString()}" in done.stdout
