"""Calibration finds what generated the shots, says what it is worth, and is of use."""

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import cradle_models
import mujoco_impact
from mujoco_impact import calibrate
from mujoco_impact.calibration import (
    Parameters,
    Shots,
    read_parameters,
    synthetic_shots,
    write_parameters,
    write_shots,
)
from mujoco_impact.calibration.grid import axes
from mujoco_impact.calibration.objective import Candidates, Objective
from mujoco_impact.calibration.search import GridEvaluation, search
from mujoco_impact.errors import ConfigError
from mujoco_impact_lab.coverage import coverage

# velocities after the first impact over that of ball 1, Hertz contacts, e = 1
# (DOP853, 1e-12; BBB is AAA): P_12 / p = 1 - v_1, P_23 / p = v_3 m_3 / m_1
FIRST_IMPACT = {
    "AAA": (-0.070952, 0.994549),
    "AAB": (-0.271542, 0.677922),
    "ABA": (-0.361986, 0.862758),
    "ABB": (-0.365382, 0.657743),
    "BAA": (0.161981, 1.359062),
    "BAB": (-0.136123, 0.958209),
    "BBA": (-0.058566, 1.282516),
    "BBB": (-0.070952, 0.994549),
}


def generating_values(pattern: str) -> tuple[float, float]:
    """alpha_1 S_h and alpha_2/alpha_1 that make (6) give the impulses, S_w = 0."""
    first, last = FIRST_IMPACT[pattern]
    mass = {"A": 0.115, "B": 0.230}
    share = 1 - first, last * mass[pattern[2]] / mass[pattern[0]]
    return share[0] / (2 / np.pi * 7.5e-3), share[1] / share[0]


@pytest.mark.parametrize("pattern", FIRST_IMPACT)
def test_exact_shots_give_the_generating_values_within_a_grid_step(pattern):
    """All of table 1 is searched; S_w, E and friction are free."""
    balls = cradle_models.balls(pattern)
    found = calibrate(synthetic_shots(balls), folds=0).parameters
    height, ratio = generating_values(pattern)
    alpha_1, alpha_2 = found.alpha
    # one step of S_h (.01) and of alpha (.001) in the product and in the ratio
    step_height = 0.001 * found.sh + 0.01 * alpha_1
    step_ratio = 0.001 / alpha_1 * (1 + alpha_2 / alpha_1)
    assert abs(alpha_1 * found.sh - height) < step_height
    assert abs(alpha_2 / alpha_1 - ratio) < step_ratio


def test_intervals_hold_the_truth_with_one_percent_noise():
    """Stated: 95 %. The whole run is docs/calibration_coverage.md; 5 seeds here.

    At a true coverage of 95 % fewer than 4 of 5 hold once in 40 runs; seeds are fixed.
    """
    rows, _ = coverage(["AAB"], seeds=range(5))
    for row in rows:
        assert row.held >= 4 / 5, row
        assert row.width < 0.05  # and they say something


def test_the_parameters_of_the_model_itself_are_found():
    """Shots made by equation (6) with S_w = 0.5: S_w is found, too."""
    exact = synthetic_shots(cradle_models.balls("AAA"), speeds=(0.2, 1.0))
    truth = Candidates(*(np.array([v]) for v in (180.0, 0.5, 0.001, 0.001)),
                       np.array([[1.1, 0.9]]))  # fmt: skip
    impulse = Objective(exact).impulses(truth)[0]
    after = exact.before + impulse / exact.masses[:, np.newaxis]
    shots = Shots(exact.masses, exact.before, after, exact.directions)
    found = calibrate(shots, folds=0).parameters
    assert found.sw == pytest.approx(0.5, abs=0.02)
    assert found.sh * found.alpha[0] == pytest.approx(180 * 1.1, rel=1e-3)
    assert found.alpha[1] / found.alpha[0] == pytest.approx(0.9 / 1.1, abs=2e-3)


def test_the_search_stays_on_the_grid_and_is_as_good_as_off_it():
    shots = synthetic_shots(cradle_models.balls("BBA"), velocity_noise=0.01)
    found = calibrate(shots, folds=0)
    for axis in axes(2):
        names = {"alpha_1": 0, "alpha_2": 1}
        given = found.parameters
        value = (given.alpha[names[axis.name]] if axis.name in names
                 else getattr(given, axis.name))  # fmt: skip
        steps = (value - axis.low) / axis.step
        assert steps == pytest.approx(round(steps), abs=1e-6)
        assert axis.low <= value <= axis.high
    # least squares off the grid, reweighted: the same to where that stops
    assert found.evaluation == pytest.approx(found.identifiability.best, rel=1e-5)


def test_a_seed_gives_the_same_result_however_the_work_is_shared():
    shots = synthetic_shots(cradle_models.balls("ABB"), count=4, velocity_noise=0.01)
    told = []
    plain = calibrate(shots, folds=2, seed=5)
    with ThreadPoolExecutor(2) as pool:
        other = calibrate(shots, folds=2, seed=5, executor=pool, progress=told.append)
    assert other.to_dict() == plain.to_dict()
    assert other.parameters == plain.parameters
    assert told[1].startswith("held out 1 of 2: evaluation value")
    evaluation = GridEvaluation(Objective(shots), axes(2))
    assert not np.array_equal(
        search(evaluation, seed=6, generations=15).values,
        search(evaluation, seed=5, generations=15).values,
    )


def test_progress_tells_each_generation():
    told = []
    shots = synthetic_shots(cradle_models.balls("AA"), count=2)
    calibrate(shots, folds=2, progress=told.append)
    assert any(text.startswith("search: generation 3") for text in told)
    assert any("held out 2 of 2" in text for text in told)


def test_what_cannot_be_determined_is_said():
    shots = synthetic_shots(cradle_models.balls("AAA"), velocity_noise=0.01)
    found = calibrate(shots, folds=0)
    ranges = {one.name: one for one in found.identifiability.ranges}
    assert (ranges["e"].low, ranges["e"].high) == (0.001, 1.0)
    # S_h can be anything that keeps alpha on its grid
    assert ranges["sh"].high == 250.0
    assert ranges["sh"].low == pytest.approx(224 / 1.5, rel=0.05)
    assert ranges["alpha_1"].high == pytest.approx(1.5)
    names = [one.name for one in found.identifiability.combinations]
    assert names == ["alpha_1 S_h", "alpha_2 S_h", "alpha_2/alpha_1",
                     "P_1/p at the mean p"]  # fmt: skip


def test_shots_of_one_speed_leave_the_width_open():
    """W and H then only count together: P_1/p is known, alpha_1 S_h hardly."""
    one_speed = synthetic_shots(
        cradle_models.balls("AAA"), speeds=(0.5, 0.5), velocity_noise=0.003
    )
    found = calibrate(one_speed, folds=0).identifiability
    width = {one.name: one for one in found.ranges}["sw"]
    assert width.high - width.low > 0.5
    share = next(one for one in found.combinations if one.name.startswith("P_1/p"))
    assert share.low < 1.070952 < share.high  # Hertz, AAA
    assert share.high - share.low < 0.03


def test_more_than_three_balls():
    found = calibrate(synthetic_shots(cradle_models.balls("AAAA")), folds=0)
    alpha = np.array(found.parameters.alpha)
    # 1.071085 1.100711 .990973 of p: published Hertz impact of four balls
    ratio = alpha[1:] / alpha[:-1]
    np.testing.assert_allclose(ratio, [1.027659, 0.900303], rtol=0, atol=2e-3)  # grid


def test_held_out_shots_are_fitted_worse_than_those_searched_on():
    shots = synthetic_shots(
        cradle_models.balls("BAB"), velocity_noise=0.02, count=6, seed=2
    )
    found = calibrate(shots, folds=3)
    assert found.held_out > found.evaluation > 0
    assert found.scale > 5 * found.held_out
    assert 0.01 < found.imbalance < 0.5


def test_too_few_shots_still_give_parameters():
    found = calibrate(synthetic_shots(cradle_models.balls("AAA"), count=2), folds=0)
    assert found.identifiability is None
    assert found.held_out is None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"folds": 1}, "folds = 1"),
        ({"kappa": -1.0}, "kappa = -1.0"),
        ({"w0": 0.0}, "w0 = 0.0"),
        ({"fixed": {"sq": 1.0}}, "unknown parameter 'sq'"),
        ({"fixed": {"e": 2.0}}, "e = 2.0; allowed: 0.001 to 1.0"),
    ],
)
def test_options_out_of_range_are_refused(options, words):
    shots = synthetic_shots(cradle_models.balls("AAA"), count=2)
    with pytest.raises(ConfigError, match=words):
        calibrate(shots, **options)


def test_the_result_plugs_into_a_model_that_then_repeats_the_shots(tmp_path):
    """attach(..., law="calibrated", **settings): the velocities of the shots."""
    shots = synthetic_shots(cradle_models.balls("AAA"))
    found = calibrate(shots, fixed={"e": 1.0}, folds=0)
    spec = mujoco_impact.attach(
        cradle_models.row("AAA", gravity=0.0, timestep=1e-3),
        law="calibrated",
        **found.settings,
    )
    motion = mujoco_impact.run(spec, duration=0.03, qvel=[0.5 / 0.3, 0, 0])
    left = motion.qvel[-1] * 0.3 / 0.5
    # the balls turn with their arms: 1e-3 of mass; and one step of the grid
    expected = [-0.070952, 0.076403, 0.994549]
    np.testing.assert_allclose(left, expected, rtol=0, atol=3e-3)
    path = found.save(tmp_path / "params.json")
    assert read_parameters(path) == found.parameters
    document = json.loads(path.read_text())
    assert document["calibration"]["shots"] == 10


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"sh": "x"}, "sh = 'x'"),
        ({"alpha": []}, "alpha = "),
        ({"alpha": 1.0}, "alpha = 1.0"),
        ({"height": 1.0}, "needs alpha"),
    ],
)
def test_damaged_parameters_are_refused(tmp_path, change, words):
    path = write_parameters(
        Parameters(200.0, 0.5, 1.0, 0.1, 0.1, (1.0, 0.9)), tmp_path / "p.json"
    )
    document = json.loads(path.read_text())
    document["parameters"] |= change
    path.write_text(json.dumps(document))
    with pytest.raises(ConfigError, match=words):
        read_parameters(path)


@pytest.mark.parametrize("text", ["", "[]", '{"format": "other"}'])
def test_files_that_are_not_parameters_are_refused(tmp_path, text):
    (tmp_path / "p.json").write_text(text)
    with pytest.raises(ConfigError, match=r"p\.json"):
        read_parameters(tmp_path / "p.json")


def test_calibrate_reads_a_file(tmp_path):
    shots = synthetic_shots(cradle_models.balls("AA"), count=3)
    path = write_shots(shots, tmp_path / "shots.csv")
    from_file = calibrate(path, folds=0)
    assert from_file.parameters == calibrate(shots, folds=0).parameters
