"""`mujoco-impact stress`: random scenes, one seed, a scene of the user's own."""

import dataclasses
import json

import numpy as np
import pytest
from typer.testing import CliRunner

import mujoco_impact
from mujoco_impact.cli import app
from mujoco_impact.impact import Impact
from mujoco_impact.stress import (
    BALLS as BALLS_FAMILY,
)
from mujoco_impact.stress import (
    FAMILIES,
    OURS,
    SHAPES,
    Finding,
    judge,
    markdown,
    stress_scene,
    user_scene,
)
from mujoco_impact.stress.long_runs import long_runs
from mujoco_impact.stress.outcomes import Outcome, differences
from mujoco_impact.stress.promises import Invariant
from mujoco_impact.stress.shapes import Evidence, case_of

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


def test_random_scenes_are_judged_and_reported(tmp_path):
    report, numbers = tmp_path / "stress.md", tmp_path / "stress.json"
    result = run("--cases", "12", "--first", "50", "--out", str(report), "--json",
                 str(numbers))  # fmt: skip
    assert result.exit_code == 0, result.output
    text = report.read_text(encoding="utf-8")
    for heading in ("The promises", f"{OURS}: 0 violations", "Side by side", "MuJoCo"):
        assert heading in text
    assert json.loads(numbers.read_text())["cases"] == 12


def test_a_case_is_shown_by_its_seed():
    result = run("--seed", "51")
    assert result.exit_code == 0
    assert "seed 51:" in result.output
    assert f"{OURS:16} same bits" in result.output


def test_a_family_leaves_the_others_their_part_of_the_report(tmp_path):
    report = tmp_path / "stress.md"
    for family in ("balls", "shapes", "shapes"):
        result = run("--family", family, "--cases", "3", "--ours-only", "--out",
                     str(report))  # fmt: skip
        assert result.exit_code in (0, 1), result.output
    text = report.read_text(encoding="utf-8")
    assert text.count("## Random balls\n") == text.count("## Random shapes\n") == 1
    assert text.index("## Random balls\n") < text.index("## Random shapes\n")


def test_a_seed_tells_what_broke_and_the_simplest_that_does(monkeypatch):
    """With a promise that no bouncing ball keeps."""
    rest = Invariant("rest", "nothing is struck", 0.0, "a test",
                     lambda evidence: float(bool(evidence.run.impacts)))  # fmt: skip
    family = dataclasses.replace(SHAPES, invariants=(rest,))
    monkeypatch.setitem(FAMILIES, "shapes", family)
    struck = next(
        seed for seed in range(20) if Evidence(case_of(seed)).run.impacts
    )  # fmt: skip
    result = run("--family", "shapes", "--seed", str(struck), "--shrink")
    assert result.exit_code == 0, result.output
    assert f"seed {struck}: [" in result.output
    assert "VIOLATED" in result.output
    assert "the simplest found that breaks rest: Case(seed=" in result.output


def test_a_family_that_is_unknown_is_refused():
    result = run("--family", "cubes", "--cases", "1")
    assert result.exit_code != 0
    assert "must be one of balls, shapes" in result.output


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


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (("row_3", "--seed", "3"), "--seed"),
        (("row_3", "--ours-only"), "--ours-only"),
        (("row_3", "--cases", "100"), "--cases"),
        (("--seed", "51", "--first", "2"), "--first"),
        (("--shrink",), "--shrink"),
        (("--cases", "1", "--keyframe", "shot"), "--keyframe"),
    ],
)
def test_an_option_without_effect_is_refused(arguments, option):
    """Rather than left out without a word."""
    result = run(*arguments)
    assert result.exit_code == 2
    assert f"{option}: no effect" in result.output


def test_a_case_is_shown_without_the_contacts_of_mujoco():
    """With --ours-only."""
    result = run("--seed", "51", "--ours-only")
    assert result.exit_code == 0
    assert "MuJoCo" not in result.output
    assert f"{OURS:16} same bits" in result.output


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


@pytest.fixture(scope="module")
def short_runs():
    return {(one.run, one.method): one for one in long_runs(hour=20, swing=60, rest=20)}


def test_the_elastic_cradle_keeps_its_energy(short_runs):
    ours = short_runs["elastic", OURS]
    assert ours.finite
    # the half step of Euler makes energies vary by h a / u, about 1e-2, both ways
    assert abs(ours.energy - 1).max() < 0.02
    assert ours.order == 0


def test_the_dissipative_cradle_comes_to_rest_and_stays(short_runs):
    ours = short_runs["dissipative", OURS]
    assert ours.finite
    assert ours.energy[-1] < 1e-3
    assert ours.speed < 1e-2
    assert ours.order == 0


def test_sentences_that_several_runs_share_stand_once():
    """And are numbers from then on."""
    long = "energy grew by 10 % of the largest kinetic energy; cure: a smaller timestep"
    finding = Finding("as it is", 1, 0, 0.0, 0.0, 0.0, 0, True, (long,))
    other = dataclasses.replace(finding, variation="RK4")
    text = markdown.findings_table([finding, other])
    assert text.count(long) == 1
    assert text.count("| (1) |") == 1
    assert f"{long} (1) |" in text
    assert "(1)" not in markdown.findings_table([finding])


def test_what_was_judged_is_kept_on_control_c(monkeypatch):
    """Of random scenes and of a scene of one's own; exit code 130."""
    usual, seen = user_scene._find, []

    def find(*arguments):
        seen.append(arguments)
        if len(seen) > 2:
            raise KeyboardInterrupt
        return usual(*arguments)

    monkeypatch.setattr(user_scene, "_find", find)
    result = run("row_3", "--duration", "0.01")
    assert result.exit_code == 130
    assert "timestep x 0.1" in result.output
    assert "interrupted after 2 runs" in result.output

    def sweep_and_stop(seeds, **options):
        for seed in seeds:
            if seed == 2:
                raise KeyboardInterrupt
            case = BALLS_FAMILY.case_of(seed)
            options["progress"](judge(case, (OURS,), family=BALLS_FAMILY))

    monkeypatch.setattr("mujoco_impact.stress.sweep", sweep_and_stop)
    result = run("--cases", "9", "--ours-only")
    assert result.exit_code == 130
    assert "2 scenes" in result.output
