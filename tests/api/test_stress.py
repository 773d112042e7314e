"""`mujoco-impact stress`: a scene of the user's own, run in many ways."""

import dataclasses

import numpy as np
import pytest
from typer.testing import CliRunner

import mujoco_impact
from mujoco_impact.cli import app
from mujoco_impact.impact import Impact
from mujoco_impact.stress import Finding, findings, stress_scene
from mujoco_impact.stress.differences import Outcome, differences

BALLS = """
<mujoco model="two">
  <option timestep="0.002" gravity="0 0 0"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
  <worldbody>
    <body pos="-.03 0 0"><joint/><geom name="a"/></body>
    <body><joint/><geom name="b"/></body>
  </worldbody>
  <keyframe><key name="shot" qvel="{speed} 0"/></keyframe>
</mujoco>
"""


def run(*arguments: str):
    return CliRunner().invoke(app, ["stress", *arguments])


def test_without_a_scene_it_says_what_is_missing():
    """And where random scenes are run."""
    result = run()
    assert result.exit_code == 2
    assert "MODEL is missing" in result.stderr
    assert "`scripts/stress`" in result.stderr


def test_a_scene_is_run_in_many_ways(tmp_path):
    path = tmp_path / "two.xml"
    path.write_text(BALLS.format(speed=1))
    result = run(str(path), "--duration", "0.1", "--keyframe", "shot")
    assert result.exit_code == 0, result.output
    # what is wrong with a variation is told, what decides is the scene as it is
    assert "impacts may be missed" in result.output
    for way in ("as it is", "timestep x 5", "integrator RK4", "restitution 0"):
        assert way in result.output


def test_a_scene_too_fast_for_its_gap_is_reported():
    """At a thousand times the gap per step an impact may be missed."""
    findings = stress_scene(
        BALLS.format(speed=1000), duration=0.05, keyframe="shot", settings={"gap": 2e-3}
    )
    assert findings[0].variation == "as it is"
    assert findings[0].farthest > 500
    assert "impacts may be missed" in " ".join(findings[0].problems)


def test_a_scene_that_has_the_plugin_is_taken_as_it_is():
    spec = mujoco_impact.attach(BALLS.format(speed=1))
    findings = stress_scene(spec, duration=0.05, keyframe="shot")
    assert not any("restitution" in finding.variation for finding in findings)
    assert all(finding.impacts == 1 for finding in findings[:5])
    assert all(finding.same_bits for finding in findings)


def test_the_command_fails_where_a_scene_does(tmp_path):
    path = tmp_path / "fast.xml"
    path.write_text(BALLS.format(speed=1000))
    result = run(str(path), "--duration", "0.01", "--keyframe", "shot", "--set",
                 "restitution=1")  # fmt: skip
    assert result.exit_code == 1
    assert "impacts may be missed" in result.output


def test_a_scene_in_which_nothing_touches_is_not_called_sound(tmp_path):
    """There is no evidence: the command fails."""
    path = tmp_path / "still.xml"
    path.write_text(BALLS.format(speed=1))
    result = run(str(path), "--duration", "0.05", "--keyframe", "none")
    assert result.exit_code == 1
    as_it_is = next(line for line in result.output.splitlines() if "as it is" in line)
    assert "nothing struck: nothing can be said; start with --keyframe shot" in as_it_is
    assert "sound" not in as_it_is


def test_a_scene_at_rest_is_not_called_sound():
    """A ball that lies on a floor touches it, but nothing strikes."""
    scene = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body pos="0 0 .02"><freejoint/><geom size=".02"/></body></worldbody></mujoco>"""
    findings = stress_scene(scene, duration=0.02)
    assert findings[0].impacts == 0
    assert findings[0].problems == ("nothing struck: nothing can be said",)


DIE = """
<mujoco>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="die" pos="0 0 .3" euler="20 30 0"><freejoint/>
      <geom type="box" size=".05 .03 .02" density="1000"/></body>
  </worldbody>
  <default><geom condim="1"/></default>
</mujoco>
"""


@pytest.fixture(scope="module")
def die():
    """The findings of an elastic box that Euler spins up, by variation."""
    return {one.variation: one for one in stress_scene(DIE, duration=1.2)}


def test_the_integrator_is_blamed_where_it_is_the_cause(die):
    """A body that it has spun up is faster than its gap, which is not the cause."""
    assert "Euler integrator adds energy" in die["as it is"].problems[0]
    assert "gap" not in " ".join(die["timestep x 2"].problems)
    assert die["integrator RK4"].problems == ()


def test_timesteps_that_come_to_something_else_say_so(die):
    """Compared with the finest timestep."""
    (told,) = die["as it is"].differences
    assert told.startswith("other than with timestep x 0.1")
    assert "impacts, not" in told
    assert "energy changes by" in told
    assert die["timestep x 0.1"].differences == ()
    assert die["integrator RK4"].differences == ()


def test_a_scene_that_its_timestep_resolves_has_no_differences():
    """Two balls: the same velocities, impacts and energy with every timestep."""
    findings = stress_scene(BALLS.format(speed=1), duration=0.05, keyframe="shot")
    assert findings[0].problems == findings[0].differences == ()
    assert not any(finding.differences for finding in findings[:4])


def test_velocities_after_the_first_impact_are_compared():
    """At the same time; what a second impact has changed is not compared."""
    time = np.linspace(0.0, 1.0, 11)
    impact = Impact(
        0.35, ("a", "b"), *[1.0] * 3, 0.1, 1.0, 1.0, 1.0, (0.0,) * 3, (1.0, 0.0, 0.0)
    )

    def outcome(speed, *impacts):
        qvel = np.where(time < 0.4, 1.0, speed)[:, None]
        impacts = impacts or (impact,)
        return Outcome(time, qvel, impacts, len(impacts), 0.0)

    assert differences(outcome(-1.0), outcome(-1.0), "x") == ()
    (told,) = differences(outcome(-1.0), outcome(-0.9), "x")
    assert told == (
        "other than with x: velocities after the first impact differ by 0.1"
    )
    # the second impact of one comes before the first of the other is over
    soon = dataclasses.replace(impact, time=0.52)
    long = dataclasses.replace(impact, duration=0.3)
    (told,) = differences(outcome(-1.0, impact, soon), outcome(-0.9, long), "x")
    assert told == "other than with x: 2 impacts, not 1"


def test_sentences_that_several_runs_share_stand_once():
    """And are numbers from then on."""
    long = "energy grew by 10 % of the largest kinetic energy; cure: a smaller timestep"
    finding = Finding("as it is", 1, 0, 0.0, 0.0, 0.0, 0, True, (long,))
    other = dataclasses.replace(finding, variation="RK4")
    text = findings.findings_table([finding, other])
    assert text.count(long) == 1
    assert text.count("| (1) |") == 1
    assert f"{long} (1) |" in text
    assert "(1)" not in findings.findings_table([finding])


def test_findings_are_kept_on_control_c(monkeypatch):
    """Exit code 130."""
    usual, seen = findings._find, []

    def find(*arguments):
        seen.append(arguments)
        if len(seen) > 2:
            raise KeyboardInterrupt
        return usual(*arguments)

    monkeypatch.setattr(findings, "_find", find)
    result = run("row_3", "--duration", "0.01")
    assert result.exit_code == 130
    assert "timestep x 0.1" in result.output
    assert "interrupted after 2 runs" in result.output
