"""dm_control's own test of its suite, run on our domains."""

import pytest

pytest.importorskip("dm_control")
pytest.importorskip("mock")
from dm_control import suite

from mujoco_impact import envs

envs.register_suite()

# suite_test makes its test cases of these constants when it is imported
with pytest.MonkeyPatch.context() as patch:
    for constant in ("ALL_TASKS", "REWARD_VIZ"):
        patch.setattr(suite, constant, envs.ALL_TASKS)
    from dm_control.suite.suite_test import SuiteTest


class TestOurs(SuiteTest):
    """Names, specifications, determinism, no constant observation, and so on."""


# the base class would be collected once more
del SuiteTest


def test_every_task_is_tested():
    names = {name for name in dir(TestOurs) if "deterministic" in name}
    assert len(names) == len(envs.ALL_TASKS) == 4
    assert set(envs.ALL_TASKS) <= set(suite.ALL_TASKS)
    assert set(envs.ALL_TASKS) <= set(suite.BENCHMARKING)
    assert suite.TASKS_BY_DOMAIN["cradle"] == ("strike", "damp", "select")
    assert suite.TASKS_BY_DOMAIN["billiards"] == ("bank",)


@pytest.mark.parametrize(("domain", "task"), envs.ALL_TASKS)
def test_the_suite_loads_what_load_loads(domain, task):
    by_suite = suite.load(domain, task, task_kwargs={"random": 3})
    ours = envs.load(domain, task, task_kwargs={"random": 3})
    action = [0.5] * by_suite.action_spec().shape[0]
    by_suite.reset()
    ours.reset()
    for _ in range(100):
        one, other = by_suite.step(action), ours.step(action)
    assert one.reward == other.reward
    for name, value in one.observation.items():
        assert (value == other.observation[name]).all()
    assert by_suite.physics.legacy_step is False
