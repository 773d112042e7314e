"""DeepMind's own test of an environment, run on every one of ours."""

import numpy as np
import pytest

pytest.importorskip("dm_control")
from absl.testing import absltest
from composer_task import environment
from dm_env import test_utils

from mujoco_impact import envs

STEPS = 20
"""Longer than the episodes, so that a step after the last is tested, too."""


class Conformance(test_utils.EnvironmentTestMixin):
    def make_action_sequence(self):
        spec = self.environment.action_spec()
        random = np.random.RandomState(0)
        for _ in range(STEPS):
            yield random.uniform(spec.minimum, spec.maximum, spec.shape)


class SuiteTask(Conformance):
    domain = "cradle"
    task: str

    def make_object_under_test(self):
        kwargs = {"random": 0, "time_limit": 0.2}
        return envs.load(self.domain, self.task, task_kwargs=kwargs)


class TestStrike(SuiteTask, absltest.TestCase):
    task = "strike"


class TestDamp(SuiteTask, absltest.TestCase):
    task = "damp"


class TestSelect(SuiteTask, absltest.TestCase):
    task = "select"


class TestBank(SuiteTask, absltest.TestCase):
    domain, task = "billiards", "bank"


class TestComposer(Conformance, absltest.TestCase):
    def make_object_under_test(self):
        return environment(time_limit=0.2)


class TestStockDomain(Conformance, absltest.TestCase):
    def make_object_under_test(self):
        kwargs = {"random": 0, "time_limit": 0.2}
        return envs.load("ball_in_cup", "catch", task_kwargs=kwargs)


def test_every_task_has_a_class():
    tested = {(one.domain, one.task) for one in SuiteTask.__subclasses__()}
    assert tested == set(envs.ALL_TASKS)
