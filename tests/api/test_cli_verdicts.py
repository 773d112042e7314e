"""What the commands say of a run that cannot be trusted, and how they end."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import cradle_models
from mujoco_impact import attach, compare
from mujoco_impact.cli import app
from mujoco_impact.comparison import OURS
from mujoco_impact.errors import ConfigError
from mujoco_impact.source import read_spec

DIE = """
<mujoco model="die">
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="die" pos="0 0 .3" euler="20 30 0"><freejoint/>
      <geom name="die" type="box" size=".05 .03 .02" density="1000"/></body>
  </worldbody>
  <default><geom condim="1"/></default>
</mujoco>
"""


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs each command in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


def command(*arguments: str) -> Result:
    """Returns the outcome of a command line."""
    return CliRunner().invoke(app, list(arguments), prog_name="mujoco-impact")


def half_elastic(source: str) -> str:
    """Returns a scene as MJCF that has the plugin with e = 0.5."""
    return str(attach(source, restitution=0.5).to_xml())


@pytest.mark.parametrize("name", ["run", "compare"])
def test_energy_from_nowhere_ends_a_command_with_exit_code_1(
    name: str, tmp_path: Path
) -> None:
    """In one sentence that names the cause, and in the JSON."""
    (tmp_path / "die.xml").write_text(DIE)
    result = command(name, "die.xml", "--duration", "1", "--json", "out.json")
    assert result.exit_code == 1, result.output
    (line,) = [one for one in result.stderr.splitlines() if "warning" in one]
    assert line.startswith("mujoco-impact: warning: energy grew by")
    assert "free rotation of 'die'" in line
    (remark,) = json.loads((tmp_path / "out.json").read_text())["remarks"]
    assert remark["kind"] == "energy"


def test_a_body_too_fast_is_told_and_the_speed_option_mends_it(
    tmp_path: Path, two_balls: str
) -> None:
    """The command line has no gap, but a speed."""
    fast = two_balls.replace('"1 0"', '"100 0"').replace("-.02 0 0", "-.25 0 0")
    (tmp_path / "fast.xml").write_text(fast)
    shot = ("run", "fast.xml", "--duration", "0.006", "--keyframe", "shot")
    result = command(*shot)
    assert "'left' closes in on 'right' at 100 m/s" in result.stderr
    result = command(*shot, "--speed", "100", "--json", "-")
    assert result.stderr.count("warning") == 0
    document = json.loads(result.stdout)
    assert len(document["impacts"]) == 1
    assert document["remarks"] == []


def test_a_run_without_impact_says_that_nothing_touched(
    tmp_path: Path, two_balls: str
) -> None:
    """With the cure; that is no failure."""
    (tmp_path / "still.xml").write_text(two_balls)
    still = ("run", "still.xml", "--duration", "0.01", "--keyframe", "none")
    result = command(*still)
    assert result.exit_code == 0
    words = " ".join(result.stdout.split())
    assert "none of the geoms that the plugin owns touched anything" in words
    native = command(*still, "--native")
    assert "no impact" not in native.stdout


def test_a_sane_run_prints_nothing_more() -> None:
    """Neither a warning nor a remark."""
    result = command("run", "row_3", "--duration", "0.5", "--json", "-")
    assert result.exit_code == 0
    assert "warning" not in result.stderr
    assert json.loads(result.stdout)["remarks"] == []


def test_native_means_without_the_plugin_of_the_scene(
    tmp_path: Path, two_balls: str
) -> None:
    """The motion is that of the scene which never had it."""
    (tmp_path / "plain.xml").write_text(two_balls)
    (tmp_path / "ours.xml").write_text(half_elastic(two_balls))
    documents = []
    for name in ("plain.xml", "ours.xml"):
        result = command(
            *("run", name, "--native", "--duration", "0.02", "--keyframe", "shot"),
            *("--json", "-"),
        )
        assert result.exit_code == 0, result.output
        documents.append(json.loads(result.stdout))
    plain, ours = documents
    assert ours["impacts"] == []
    assert ours["qvel"] == plain["qvel"]


def test_compare_keeps_the_settings_of_the_scene(two_balls: str) -> None:
    """A scene with e = 0.5 is compared with e = 0.5, the damper tuned to it."""
    comparison = compare(
        half_elastic(two_balls), duration=0.02, keyframe="shot", repeats=1
    )
    ours = comparison.method(OURS)
    assert ours.setting == "restitution=0.5"
    assert ours.trajectory is not None
    # the tolerance of the law
    assert ours.trajectory.qvel[-1] == pytest.approx([0.25, 0.75], abs=1e-5)
    damper = comparison.method("MuJoCo damper").trajectory
    assert damper is not None
    assert damper.qvel[-1] == pytest.approx([0.25, 0.75], abs=1e-2)
    assert comparison.geoms == ("left", "right")


def test_compare_keeps_gap_and_geoms_of_the_scene() -> None:
    """And tells the reference of the material that is set."""
    spec = attach(cradle_models.model_path("row_3"), gap=0.02, young=1e9)
    comparison = compare(spec, duration=0.4, keyframe="release", repeats=1)
    assert comparison.row is not None
    assert comparison.row.chain.young == 1e9
    sight = comparison.model.geom_gap + comparison.model.geom_margin
    assert sight.max() == pytest.approx(0.02)


@pytest.mark.parametrize(
    "options",
    [{"settings": {"restitution": 0.9}}, {"gap": 0.1}, {"speed": 9.0}, {"geoms": "a"}],
)
def test_compare_refuses_what_would_have_no_effect(
    two_balls: str, options: dict[str, object]
) -> None:
    """As `run` does."""
    word = next(iter(options)).replace("settings", "restitution")
    with pytest.raises(ConfigError, match=f"{word}: no effect.*has the plugin"):
        compare(read_spec(half_elastic(two_balls)), duration=0.02, **options)  # type: ignore[arg-type]
