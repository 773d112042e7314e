"""The scores in docs/environments.md are those of these policies."""

import inspect

import numpy as np
import pytest

pytest.importorskip("gymnasium")
from mujoco_impact_lab.bench import policies
from mujoco_impact_lab.bench.scores import score


def test_the_script_is_short():
    assert len(inspect.getsource(policies).splitlines()) < 60


@pytest.mark.parametrize(
    ("task", "random", "scripted"),
    [("strike", 150, 460), ("damp", 20, 300), ("select", 80, 150)],
)
def test_scripted_policies_solve_what_random_ones_do_not(task, random, scripted):
    """Means over 5 episodes of 500 steps with rewards up to 1; docs: 20 episodes."""
    assert np.mean(score(task, "random", episodes=5)) < random
    assert np.mean(score(task, "scripted", episodes=5)) > scripted
