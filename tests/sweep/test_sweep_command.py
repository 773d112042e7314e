"""`mujoco-impact sweep`: what it writes and says, and that it goes on after a kill."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from mujoco_impact.cli import app

SPECIFICATION = """
duration = 0.04
record = ["velocity_error", "impulse"]
[scene]
model = "two_balls.xml"
[grid]
attach.restitution = { from = 0, to = 1, count = 10 }
"""


@pytest.fixture(autouse=True)
def folder(scene: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with a scene and a specification."""
    monkeypatch.chdir(scene.parent)
    (scene.parent / "study.toml").write_text(SPECIFICATION)
    return scene.parent


def command(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["sweep", *arguments], prog_name="mujoco-impact")


def test_it_writes_rows_and_a_picture_and_says_where(folder: Path) -> None:
    pytest.importorskip("matplotlib")
    done = command("study.toml", "--processes", "1", "--plot", "study.png")
    assert done.exit_code == 0, done.output
    assert done.stdout == "10 rows: study.csv\npicture: study.png\n"
    assert len((folder / "study.csv").read_text().splitlines()) == 11
    assert (folder / "study.png").read_bytes().startswith(b"\x89PNG")


def test_it_is_killed_and_goes_on_where_it_stopped(folder: Path) -> None:
    """Without a chance to say anything; the file is that of a sweep in one go."""
    text = SPECIFICATION.replace("count = 10", "count = 40")
    (folder / "study.toml").write_text(text)
    arguments = ["study.toml", "--processes", "1", "--out", "cut.csv"]
    main = subprocess.Popen(
        [sys.executable, "-m", "mujoco_impact", "sweep", *arguments]
    )
    cut = folder / "cut.csv"
    while not cut.exists() or cut.read_bytes().count(b"\n") < 4:
        assert main.poll() is None
        time.sleep(0.01)
    main.kill()
    main.wait()
    left = cut.read_bytes()
    assert left.count(b"\n") < 41
    assert command(*arguments).exit_code == 0
    assert command("study.toml", "--processes", "1").exit_code == 0
    assert cut.read_bytes() == (folder / "study.csv").read_bytes()
    # what was there was not computed anew
    assert cut.read_bytes().startswith(left)


def test_it_says_what_failed(folder: Path) -> None:
    text = SPECIFICATION.replace("{ from = 0, to = 1, count = 10 }", "[1.0, 1.5]")
    (folder / "study.toml").write_text(text)
    done = command("study.toml", "--processes", "1")
    assert done.exit_code == 0, done.output
    assert "1 failed (column error); the first, case 1: ConfigError: the" in done.stdout
    # nothing but failures: no reference, and a case without an impact
    text = SPECIFICATION.replace("0.04", "0.001")
    (folder / "none.toml").write_text(text)
    done = command("none.toml", "--processes", "1")
    assert done.exit_code == 1
    assert "10 failed" in done.stdout


def test_rows_of_another_specification_are_refused_until_they_are_thrown_away(
    folder: Path,
) -> None:
    assert command("study.toml", "--processes", "1").exit_code == 0
    (folder / "study.toml").write_text(SPECIFICATION.replace("0.04", "0.05"))
    refused = command("study.toml", "--processes", "1")
    assert refused.exit_code == 2
    assert "duration was 0.04, and is 0.05" in refused.stderr
    assert "--restart" in refused.stderr
    assert command("study.toml", "--processes", "1", "--restart").exit_code == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("duration = ", "study.toml is not valid TOML: Invalid value"),
        ("duration = 1", "study.toml: scene: give either model"),
        (SPECIFICATION + "attach.yung = [1]", "study.toml: grid.attach.yung: attach"),
        ("\xff", "study.toml"),
    ],
)
def test_what_is_wrong_is_one_sentence_with_the_file(
    folder: Path, text: str, message: str
) -> None:
    (folder / "study.toml").write_text(text, encoding="latin-1")
    done = command("study.toml")
    assert done.exit_code == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_one_way_to_run_is_given() -> None:
    done = command("study.toml", "--processes", "2", "--local", "2")
    assert done.exit_code == 2
    assert "--processes and --local: give one of them" in done.stderr
