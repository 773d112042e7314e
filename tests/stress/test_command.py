"""`python -m mujoco_impact_lab stress`: random scenes, and one of them."""

import dataclasses
import json

import pytest
from typer.testing import CliRunner

from mujoco_impact_lab.__main__ import app
from mujoco_impact_lab.stress import BALLS, FAMILIES, OURS, SHAPES, judge
from mujoco_impact_lab.stress.long_runs import long_runs
from mujoco_impact_lab.stress.promises import Invariant
from mujoco_impact_lab.stress.shapes import Evidence, case_of


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


@pytest.mark.parametrize("option", ["--seed", "--cases", "--processes"])
def test_numbers_out_of_range_name_their_option(option):
    result = run(option, "-1")
    assert result.exit_code == 2
    assert option in result.stderr


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (("--seed", "51", "--first", "2"), "--first"),
        (("--shrink",), "--shrink"),
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


def test_what_was_judged_is_kept_on_control_c(monkeypatch):
    """Exit code 130."""

    def sweep_and_stop(seeds, **options):
        for seed in seeds:
            if seed == 2:
                raise KeyboardInterrupt
            case = BALLS.case_of(seed)
            options["progress"](judge(case, (OURS,), family=BALLS))

    monkeypatch.setattr("mujoco_impact_lab.stress.sweep", sweep_and_stop)
    result = run("--cases", "9", "--ours-only")
    assert result.exit_code == 130
    assert "2 scenes" in result.output
