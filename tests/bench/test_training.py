"""The policy of the documentation was learned by the script that it shows."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("gymnasium")
pytest.importorskip("cma")
from mujoco_impact_lab.bench import policies
from mujoco_impact_lab.training import comparison, results, strike

ROOT = Path(__file__).parents[2]
STORED = ROOT / "docs" / "benchmarks" / "training.json"


def first_generations(count):
    """One worker in this process."""
    with ThreadPoolExecutor(1) as pool:
        return list(strike.train(strike.make_env, pool, generations=count))


def test_a_few_generations_improve_and_a_seed_gives_the_same_policies(monkeypatch):
    monkeypatch.setattr(strike, "SEEDS", strike.SEEDS[:1])
    found = first_generations(4)
    again = first_generations(2)
    # measured: .024 of 1 in the first generation, .13 in the fourth
    assert found[-1].reward.mean() > 2 * found[0].reward.mean()
    for one, other in zip(found, again, strict=False):
        np.testing.assert_array_equal(one.parameters, other.parameters)
        np.testing.assert_array_equal(one.reward, other.reward)


def test_everyone_plays_under_all_contacts(monkeypatch):
    monkeypatch.setattr(strike, "SEEDS", strike.SEEDS[:1])
    monkeypatch.setattr(comparison, "EPISODES", 1)
    told = []
    with ThreadPoolExecutor(1) as pool:
        found = comparison.compare(pool, generations=1, report=told.append)
    contacts = list(comparison.CONTACTS)
    assert len(told) == len(contacts)
    assert list(found.trainings) == contacts
    for player, scores in found.scores.items():
        assert list(scores) == contacts
        # other contacts, another motion
        assert len({one.mean for one in scores.values()}) == len(contacts), player
    for name, training in found.trainings.items():
        assert training.scores[-1] == found.scores[f"trained under {name}"][name]


def test_the_damper_is_set_for_our_restitution():
    model = comparison.reflecting(1).unwrapped.model
    # no stiffness, and damping that reverses the speed in a step: (1 + .95) / 2 ms
    np.testing.assert_allclose(model.geom_solref, [[0.0, -975.0]] * 5)
    assert model.nplugin == 0


def test_the_action_is_the_polynomial():
    """Each term by hand, at an observation of ones."""
    observation = {"angles": [0.4, 9.0], "speeds": [5.0], "reach": [0.03],
                   "target": [0.09]}  # fmt: skip
    values = np.array([1.0, 2.0, 1.0, 3.0])
    for i, powers in enumerate(strike.POWERS):
        parameters = 0.01 * (np.arange(strike.SIZE) == i)
        expected = 0.01 * values[0] ** powers[0] * values[1] ** powers[1]
        expected *= values[2] ** powers[2] * values[3] ** powers[3]
        (action,) = strike.act(parameters, observation)
        assert action == pytest.approx(np.tanh(expected), rel=1e-12)


def test_every_combination_of_powers_is_there_once():
    assert {tuple(powers) for powers in strike.POWERS.tolist()} == {
        (a, b, c, d)
        for a in range(4)
        for b in range(4)
        for c in range(4)
        for d in range(4)
        if a + b + c + d <= 3
    }
    assert strike.SIZE == 35


@pytest.mark.parametrize(
    ("contacts", "least", "most"),
    [("ours", 1.0, 1.2), ("MuJoCo's defaults", 4.5, 5.0)],
)
def test_balls_that_go_out_together_are_counted(contacts, least, most):
    """One ball with impacts, the row as a whole with MuJoCo's default contacts."""
    watched = comparison.Watched(policies.strike)
    strike.play(comparison.CONTACTS[contacts](250), watched, 0)
    assert least <= np.mean(watched.counts) <= most


def test_the_stored_policy_plays_far_above_random():
    """Over 3 episodes that it was not trained on; docs: 20 episodes."""
    learned = tuple(results.read(STORED).trainings["ours"].parameters)
    env = strike.make_env(comparison.EPISODE)
    mean = {
        player: np.mean(
            [
                strike.play(env, comparison.policy_of(player, seed), seed)
                for seed in range(3)
            ]
        )
        for player in ("random", learned)
    }
    assert mean["random"] < 150
    assert mean[learned] > 300


def test_the_documentation_shows_what_is_stored(tmp_path):
    found = results.read(STORED)
    page = (ROOT / "docs" / "environments.md").read_text(encoding="utf-8")
    assert results.table(found) in page
    data, picture = results.write(found, tmp_path / "out")
    assert data.read_bytes() == STORED.read_bytes()
    assert picture.stat().st_size > 10_000
