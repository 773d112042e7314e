"""The gymnasium environments: the same tasks, clean by gymnasium's own checks."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("gymnasium")
import gymnasium
from gymnasium.utils.env_checker import check_env

from mujoco_impact import envs
from mujoco_impact.errors import ConfigError, SimulationError

IDS = [envs.environment_id(*game) for game in envs.ALL_TASKS]


@pytest.fixture(params=IDS)
def env(request):
    environment = gymnasium.make(request.param)
    yield environment
    environment.close()


def test_the_ids_are_those_of_the_tasks():
    assert IDS == [
        "mujoco_impact/CradleStrike-v0",
        "mujoco_impact/CradleDamp-v0",
        "mujoco_impact/CradleSelect-v0",
        "mujoco_impact/BilliardsBank-v0",
    ]
    assert set(IDS) <= set(gymnasium.registry)


def test_check_env_has_nothing_to_say(env):
    """Its warnings would be errors here. Rendering needs OpenGL: not in this test."""
    check_env(env.unwrapped, skip_render_check=True)


def test_episodes_end_by_the_time_limit_only(env):
    env.reset(seed=0)
    for step in range(1, 501):
        observation, reward, terminated, truncated, _ = env.step(
            env.action_space.sample()
        )
        assert observation in env.observation_space
        assert 0.0 <= reward <= 1.0
        assert not terminated
        assert truncated == (step == 500)


def by_pickle(env):
    return pickle.loads(pickle.dumps(env))


@pytest.mark.parametrize("duplicate", [copy.deepcopy, by_pickle])
def test_a_copy_in_mid_episode_continues_bit_for_bit(env, duplicate):
    one = env.unwrapped
    one.reset(seed=5)
    actions = np.random.default_rng(0).uniform(-1, 1, (150, *one.action_space.shape))
    for action in actions[:50]:
        one.step(action)
    other = duplicate(one)
    for action in actions[50:]:
        (seen, reward, *_), (twin, twin_reward, *_) = (
            one.step(action),
            other.step(action),
        )
        np.testing.assert_array_equal(seen, twin)
        assert reward == twin_reward
    assert other.data is not one.data


def test_contacts_and_settings_can_be_chosen():
    name = IDS[0]
    stock = gymnasium.make(name, contacts="mujoco").unwrapped
    assert stock.model.nplugin == 0
    assert "impulses" not in stock.observation_names
    soft = gymnasium.make(name, pattern="ABA", restitution=0.5).unwrapped
    assert soft.model.njnt == 3
    ends = [where.stop for where in soft.observation_names.values()]
    assert ends[-1] == soft.observation_space.shape[0]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"task": "hit"}, "there is no task 'cradle hit' .available: .'cradle strike'"),
        ({"render_mode": "human"}, "render_mode = 'human': allowed are None and"),
        ({"contacts": "soft"}, "contacts = 'soft': allowed are 'impact' and 'mujoco'"),
        ({"contacts": "mujoco", "young": 1e9}, "takes no settings, got young"),
        ({"restitution": 2.0}, "restitution"),
    ],
)
def test_bad_options_are_refused_with_a_reason(options, said):
    from mujoco_impact.envs.gym import ImpactEnv

    with pytest.raises(ConfigError, match=said):
        ImpactEnv(**{"domain": "cradle", "task": "strike", **options})


def test_a_simulation_that_breaks_down_is_an_error():
    env = gymnasium.make(IDS[0]).unwrapped
    env.reset(seed=0)
    env.data.qvel[0] = np.nan
    with pytest.raises(SimulationError, match="mjWARN_BADQVEL"):
        env.step(np.zeros(1))


def test_dm_control_and_gymnasium_play_the_same_game():
    """Same start, same actions: the same observations and rewards, bit for bit."""
    pytest.importorskip("dm_control")
    for name, (domain, task) in zip(IDS, envs.ALL_TASKS, strict=True):
        theirs = envs.load(domain, task, task_kwargs={"random": 0})
        theirs.reset()
        env = gymnasium.make(name).unwrapped
        env.reset(seed=0)
        env.data.qpos[:] = theirs.physics.data.qpos
        # what the other drew at random
        env._task = copy.deepcopy(theirs.task.rules)
        rng = np.random.default_rng(1)
        for _ in range(200):
            action = rng.uniform(-1, 1, env.action_space.shape)
            step = theirs.step(action)
            observation, reward, *_ = env.step(action)
            flat = np.concatenate(list(step.observation.values()))
            np.testing.assert_array_equal(observation, flat)
            assert reward == step.reward


def test_shimmy_makes_a_gymnasium_environment_of_the_dm_control_one():
    pytest.importorskip("dm_control")
    shimmy = pytest.importorskip("shimmy")
    theirs = envs.load("cradle", "strike", task_kwargs={"random": 0})
    env = shimmy.DmControlCompatibilityV0(theirs)
    observation, _ = env.reset(seed=0)
    assert observation in env.observation_space
    for _ in range(20):
        observation, reward, *_ = env.step(env.action_space.sample())
        assert observation in env.observation_space
        assert 0.0 <= reward <= 1.0
    # it pickles the environment, MjData with the plugin and all
    twin = pickle.loads(pickle.dumps(env))
    assert twin.reset(seed=0)[0].keys() == observation.keys()


@pytest.mark.parametrize(
    "script",
    [
        # in the order in which imports are sorted
        "import gymnasium, mujoco_impact; gymnasium.make('{0}')",
        "import mujoco_impact.envs, gymnasium; gymnasium.make('{0}')",
        "import gymnasium; gymnasium.make('mujoco_impact:{0}')",
    ],
)
def test_importing_the_package_registers_the_environments(script):
    subprocess.run([sys.executable, "-c", script.format(IDS[0])], check=True)
