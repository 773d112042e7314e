"""`compare` of scenes that are no rows: what a user asks, and nothing empty."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import mujoco_impact.comparing.compare as comparing_module
from mujoco_impact import Comparison, compare
from mujoco_impact.cli import app, tables
from mujoco_impact.cli.output import PlainConsole
from mujoco_impact.comparison import AS_IS, OURS
from mujoco_impact.errors import ComparisonInterrupted, SceneError

BILLIARD = """
<mujoco model="billiard">
  <default><geom friction=".05"/></default>
  <worldbody>
    <geom name="table" type="plane" size="2 1 .1" friction=".2"/>
    <body name="cue" pos="-.2 0 .0286"><freejoint/>
      <geom name="cue" size=".0286" mass=".17"/></body>
    <body name="eight" pos="0 .02 .0286"><freejoint/>
      <geom name="eight" size=".0286" mass=".17"/></body>
  </worldbody>
  <keyframe>
    <key name="shot" qpos="-.2 0 .0286 1 0 0 0 0 .02 .0286 1 0 0 0"
         qvel="2 0 0 0 69.93 0 0 0 0 0 0 0"/>
  </keyframe>
</mujoco>
"""

BALL = """
<mujoco model="ball">
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 .25"><freejoint/><geom name="ball" size=".05"/></body>
  </worldbody>
</mujoco>
"""

SPHERES = """
<mujoco model="spheres">
  <option gravity="0 0 0"/>
  <default><geom size=".03" condim="1" mass=".2"/></default>
  <worldbody>
    <body name="a" pos="-.1 0 0"><freejoint/><geom name="a"/></body>
    <body name="b" pos="0 .03 0"><freejoint/><geom name="b" mass=".3"/></body>
    <body name="c" pos="0 -.03 0"><freejoint/><geom name="c"/></body>
  </worldbody>
</mujoco>
"""
COMING_IN = [1.0, *[0.0] * 17]


@pytest.fixture(scope="module")
def billiard() -> Comparison:
    """Two balls on a table; the file's only keyframe is the start."""
    return compare(BILLIARD, duration=0.4, repeats=1)


@pytest.fixture(scope="module")
def ball() -> Comparison:
    """A ball that falls straight down, e = 0.8."""
    return compare(BALL, duration=0.5, repeats=1, settings={"restitution": 0.8})


@pytest.fixture(scope="module")
def spheres() -> Comparison:
    """A sphere that strikes two that touch, in a plane, without friction."""
    return compare(SPHERES, duration=0.2, repeats=1, qvel=COMING_IN)


def shown(comparison: Comparison) -> str:
    """Returns what the command prints of a comparison, 80 columns wide."""
    console = PlainConsole(width=80, record=True, markup=False, highlight=False)
    with console.capture() as captured:
        console.print(tables.speed_table(comparison))
        console.print(tables.comparison_table(comparison))
    return captured.get()


def test_a_billiard_shot_starts_from_the_only_keyframe(billiard: Comparison) -> None:
    """And tells who was how fast before and after."""
    assert billiard.start == "keyframe 'shot'"
    assert billiard.bodies == ("cue", "eight")
    ours = billiard.method(OURS)
    assert ours.before is not None
    assert ours.after is not None
    speeds = np.linalg.norm(np.stack([ours.before, ours.after]), axis=2)
    assert speeds[0] == pytest.approx([2.0, 0.0], abs=0.02)
    # elastic, hardly any friction between them: cos and sin of the angle of the centres
    sine = 0.02 / (2 * 0.0286)
    expected = 2.0 * np.array([sine, math.sqrt(1 - sine**2)])
    # the table's friction acts before the shot and while the window lasts
    assert speeds[1] == pytest.approx(expected, abs=0.1)
    assert "slide on each other with friction" in billiard.note


def test_no_column_is_empty_and_no_number_is_cut(
    billiard: Comparison, ball: Comparison, spheres: Comparison
) -> None:
    """In 80 columns; errors only where there are some."""
    for comparison in (billiard, ball, spheres):
        text = shown(comparison)
        assert "…" not in text
        assert "nan" not in text
        assert max(map(len, text.splitlines())) <= 80
        assert ("error" in text) == (comparison.impact_reference is not None)
        assert "passed" not in text
        for body in comparison.bodies:
            assert body in text


def test_a_falling_ball_has_a_closed_form(ball: Comparison) -> None:
    """v' = e u, from the height; MuJoCo's default is far from it, the damper near."""
    assert ball.impact_reference is not None
    speed = math.sqrt(2 * 9.81 * 0.2)
    # Euler meets the floor within h g
    assert ball.impact_speed == pytest.approx(speed, abs=0.02)
    ours, default = ball.method(OURS), ball.method(AS_IS)
    assert ours.velocity_error is not None
    assert default.velocity_error is not None
    # measured 3e-5: energy is given back in parts of what the weight adds meanwhile
    assert ours.velocity_error < 2e-4
    assert default.velocity_error > 0.3
    best = ball.best_tuned()
    assert best is not None
    assert best.name == "MuJoCo damper"
    assert "MuJoCo's default" in ball.headline()
    assert best.name in ball.headline()
    row = ball.table()[0]
    # one bounce: 1 - e² of what it had
    assert row["impacts"] == 1
    assert row["energy_lost"] == pytest.approx(0.36, abs=0.005)


def test_spheres_without_friction_are_judged_by_the_hertz_problem(
    spheres: Comparison,
) -> None:
    """Two contacts at once, in a plane; measured 4e-4, for normals turn meanwhile."""
    assert spheres.impact_reference is not None
    assert spheres.impact_reference.name == "Hertz reference"
    ours = spheres.method(OURS)
    assert ours.velocity_error is not None
    assert ours.velocity_error < 2e-3
    for method in spheres.methods[1:5]:
        assert method.velocity_error is not None
        assert method.velocity_error > 10 * ours.velocity_error
    assert len(spheres.first.meetings) == 2
    momentum = np.array([0.2, 0.3, 0.2]) @ spheres.impact_reference.velocities
    assert momentum == pytest.approx([0.2, 0.0, 0.0], abs=1e-9)


def test_a_sphere_that_is_struck_while_it_touches_another() -> None:
    """The other is in the reference, though it takes no part in the impact."""
    askew = SPHERES.replace('"-.1 0 0"', '"-.1 .001 0"')
    comparison = compare(askew, duration=0.1, repeats=1, qvel=COMING_IN)
    assert comparison.bodies == ("a", "b")
    assert comparison.impact_reference is not None
    assert comparison.impact_reference.name == "Hertz reference"
    error = comparison.method(OURS).velocity_error
    assert error is not None
    # measured 5e-4
    assert error < 2e-3


def test_bodies_that_pass_through_each_other_are_named() -> None:
    """MuJoCo's contacts do not see a sphere that flies over a radius in a step."""
    fast = [100.0, *[0.0] * 17]
    comparison = compare(SPHERES, duration=0.01, repeats=1, qvel=fast, speed=100.0)
    default = comparison.method(AS_IS)
    assert default.seen is not None
    assert ("a", "b") in default.seen.passed or ("a", "c") in default.seen.passed
    ours = comparison.method(OURS)
    assert ours.seen is not None
    assert ours.seen.passed == ()
    assert "passed" in shown(comparison)


def test_what_comes_of_it_is_short_and_plain_json(
    billiard: Comparison, tmp_path: Path
) -> None:
    """The repr is one line; the picture is one; a notebook gets HTML."""
    assert len(repr(billiard)) < 120
    assert len(repr(billiard.methods)) < 1000
    document = json.loads(json.dumps(billiard.to_dict(), allow_nan=False))
    assert document["bodies"] == ["cue", "eight"]
    assert "<table>" in billiard._repr_html_()
    assert billiard.plot(tmp_path / "shot.png").stat().st_size > 50_000


def test_a_comparison_that_is_interrupted_keeps_what_it_has(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """In Python as an error that holds it; the command prints it and exits with 130."""
    usual, calls = comparing_module.run, []

    def run_and_stop(*arguments: Any, **options: Any) -> Any:
        calls.append(options)
        if len(calls) > 2:
            raise KeyboardInterrupt
        return usual(*arguments, **options)

    monkeypatch.setattr(comparing_module, "run", run_and_stop)
    with pytest.raises(ComparisonInterrupted) as stopped:
        compare(BALL, duration=0.4)
    kept = stopped.value.comparison
    assert [method.name for method in kept.methods] == [OURS, AS_IS]
    calls.clear()
    monkeypatch.chdir(tmp_path)
    Path("ball.xml").write_text(BALL)
    done = CliRunner().invoke(app, ["compare", "ball.xml", "--duration", "0.4"])
    assert done.exit_code == 130, done.output
    assert AS_IS in done.stdout
    assert "interrupted after" in done.stderr


def test_a_scene_without_an_impact_says_from_where_it_started() -> None:
    """And which keyframes there are."""
    with pytest.raises(SceneError, match=r"from the initial state.*\(shot\)"):
        compare(BILLIARD, duration=0.02, keyframe="none")
