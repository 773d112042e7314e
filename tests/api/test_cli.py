"""The command line: outputs, JSON, and errors as one sentence."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from mujoco_impact import Trajectory
from mujoco_impact.cli import app


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs each command in a folder of its own, 100 columns wide."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


def command(*arguments: str) -> Result:
    """Returns the outcome of a command line."""
    return CliRunner().invoke(app, list(arguments), prog_name="mujoco-impact")


def test_demo_shows_the_velocities_and_writes_a_picture(tmp_path: Path) -> None:
    """Ours, MuJoCo's and the reference, side by side."""
    result = command("demo", "--json", "demo.json")
    assert result.exit_code == 0, result.output
    for text in ("Hertz reference", "mujoco-impact", "MuJoCo damper", "ball 5", "[v0]"):
        assert text in result.stdout
    assert (tmp_path / "mujoco_impact_demo.png").stat().st_size > 50_000
    document = json.loads((tmp_path / "demo.json").read_text())
    ours, as_is = document["methods"][:2]
    assert ours["velocity_error"] < as_is["velocity_error"] / 100


def test_run_lists_impacts_and_saves_the_trajectory() -> None:
    """A shipped model starts from its keyframe "release"."""
    result = command("run", "row_3", "--duration", "0.5", "--out", "swing")
    assert result.exit_code == 0, result.output
    assert "ball_1 - ball_2" in result.stdout
    trajectory = Trajectory.load("swing.npz")
    assert trajectory.qpos[0, 0] == pytest.approx(-0.5235987755982988)
    assert len(trajectory.impacts) >= 2


def test_run_takes_settings_a_file_and_a_keyframe(
    tmp_path: Path, two_balls: str
) -> None:
    """JSON on standard output is nothing but JSON."""
    (tmp_path / "scene.xml").write_text(two_balls)
    result = command(
        *("run", "scene.xml", "--duration", "0.02", "--keyframe", "shot"),
        *("--set", "restitution=0.5", "--set", "young=1e9", "--json", "-"),
    )
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["qvel"] == pytest.approx([0.25, 0.75], abs=1e-5)
    (impact,) = document["impacts"]
    assert impact["impulse"] == pytest.approx(0.075, rel=1e-5)
    assert "impacts: 1" in result.stderr


def test_run_native_leaves_the_contacts_to_mujoco() -> None:
    """No plugin, no impacts."""
    result = command("run", "row_3", "--duration", "0.5", "--native", "--json", "-")
    assert json.loads(result.stdout)["impacts"] == []


def test_compare_writes_table_and_picture(tmp_path: Path) -> None:
    """The picture is named after the model."""
    result = command("compare", "row_3", "--duration", "0.5", "--json", "-")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["picture"] == "row_3_comparison.png"
    assert (tmp_path / "row_3_comparison.png").is_file()
    assert "velocity" in result.stderr


def test_doctor_finds_a_healthy_installation() -> None:
    """The known answers come out right."""
    result = command("doctor", "--json", "-")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["healthy"]
    names = [check["name"] for check in document["checks"]]
    assert names[-2:] == ["elastic impact", "impact with e = 0.5"]


def test_doctor_tells_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And stops there, with exit code 2."""
    monkeypatch.setenv("MUJOCO_IMPACT_PLUGIN", str(tmp_path / "nowhere.so"))
    result = command("doctor")
    assert result.exit_code == 2
    assert "FAILED" in result.stdout
    assert "there is no such file" in " ".join(result.stdout.split())


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("run", "row_4"), "no shipped model of that name; did you mean 'row_5'"),
        (("run", "row_3", "--set", "yong=1"), "did you mean 'young'"),
        (("run", "row_3", "--set", "young=-1"), "'young' = '-1'"),
        (("run", "row_3", "--set", "young"), "must be KEY=VALUE"),
        (
            ("run", "row_3", "--set", "friction=0.3"),
            "friction=0.3: must be coulomb, by MuJoCo's contacts | none | paper; "
            "coefficients are those of the scene",
        ),
        (("run", "row_3", "--speed", "-1"), "--speed -1.0: must be a speed > 0"),
        (("run", "row_3", "--keyframe", "top"), "no keyframe 'top'"),
        (("run", "row_3", "--duration", "-1"), "duration = -1.0"),
        (("run", "row_3", "--native", "--set", "young=1"), "cannot change"),
        (("compare", "row_3", "--keyframe", "none"), "no impact within"),
        (("run", "row_3", "--json", "no/such/folder.json"), "No such file"),
    ],
)
def test_errors_are_one_sentence_on_standard_error(
    arguments: tuple[str, ...], reason: str
) -> None:
    """Exit code 2 and no traceback."""
    result = command(*arguments)
    assert result.exit_code == 2
    assert reason in result.stderr
    assert result.stderr.startswith("mujoco-impact: ")
    assert result.stderr.count("\n") == 1
    assert "Traceback" not in result.output


def test_module_is_a_command() -> None:
    """`python -m mujoco_impact` does the same."""
    result = subprocess.run(
        [sys.executable, "-m", "mujoco_impact", "--help"],
        check=True,
        capture_output=True,
        text=True,
    )
    for name in ("demo", "run", "compare", "doctor"):
        assert name in result.stdout


def test_shots_calibrate_and_run_with_what_was_found(tmp_path: Path) -> None:
    """The whole way: shots, parameters, a model that uses them."""
    made = command("shots", "ABA", "--out", "shots.csv", "--count", "5")
    assert made.exit_code == 0, made.output
    found = command(
        *("calibrate", "shots.csv", "--out", "p.json", "--folds", "0"),
        *("--fix", "e=1", "--json", "found.json"),
    )
    assert found.exit_code == 0, found.output
    for text in ("alpha_2/alpha_1", "only alpha_k S_h counts", "evaluation value"):
        assert text in found.stdout
    document = json.loads((tmp_path / "found.json").read_text())
    assert document["parameters"]["e"] == 1.0
    result = command(
        *("run", "paper_aba", "--params", "p.json", "--duration", "0.4"),
        *("--json", "-"),
    )
    assert result.exit_code == 0, result.output
    impacts = json.loads(result.stdout)["impacts"]
    alphas = [impact["alpha"] for impact in impacts[:2]]
    assert alphas == document["parameters"]["alpha"]


def test_params_give_way_to_set() -> None:
    """A setting given by hand replaces that of the file."""
    command("shots", "AAA", "--count", "4", "--error", "0")
    command("calibrate", "shots.csv", "--folds", "0")
    result = command(
        *("run", "row_3", "--params", "params.json", "--duration", "0.3"),
        *("--set", "alpha=1 0.5", "--friction", "--set", "mu_d=0.1", "--json", "-"),
    )
    assert result.exit_code == 0, result.output
    impacts = json.loads(result.stdout)["impacts"]
    assert [impact["alpha"] for impact in impacts[:2]] == [1.0, 0.5]


def test_a_calibration_that_cannot_be_says_why_in_one_sentence(tmp_path: Path) -> None:
    """Line and column of the data, or the option that is wrong."""
    (tmp_path / "bad.csv").write_text("m1 [kg],m2 [g]\n")
    cases = (
        (("calibrate", "bad.csv"), "line 1, column 'm2' has the unit [g]"),
        (("calibrate", "none.csv"), "No such file"),
        (("shots", "AXA"), "unknown letters"),
        (("run", "row_3", "--params", "bad.csv"), "cannot read parameters"),
        (("run", "row_3", "--friction"), "--friction needs --params"),
    )
    for arguments, words in cases:
        result = command(*arguments)
        assert result.exit_code == 2
        assert words in result.stderr
        assert len(result.stderr.strip().splitlines()) == 1
