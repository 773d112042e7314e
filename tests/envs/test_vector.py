"""Vector environments are single ones, bit for bit, however they are stepped."""

import copy

import mujoco
import numpy as np
import pytest

pytest.importorskip("gymnasium")
import gymnasium
from gymnasium.vector import AutoresetMode

from mujoco_impact import envs
from mujoco_impact.errors import ConfigError, SimulationError

IDS = [envs.environment_id(*game) for game in envs.ALL_TASKS]

EPISODE, STEPS = 25, 80
"""Three episodes, and a part of the fourth; impacts have begun by then."""


def make(name, *, num_envs=3, **options):
    return gymnasium.make_vec(name, num_envs=num_envs, **options)


def actions(vector, steps=STEPS):
    return np.random.default_rng(7).uniform(-1, 1, (steps, *vector.action_space.shape))


def play(vector, *, seed=3):
    """Returns what each step gave, the reset first."""
    observation, infos = vector.reset(seed=seed)
    assert infos == {}
    found = [(observation.copy(),)]
    for action in actions(vector):
        *arrays, infos = vector.step(action)
        assert infos == {}
        found.append(tuple(one.copy() for one in arrays))
    vector.close()
    return found


def assert_same(one, other):
    for step, twin in zip(one, other, strict=True):
        for array, expected in zip(step, twin, strict=True):
            assert array.dtype == expected.dtype
            np.testing.assert_array_equal(array, expected)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("threads", [1, 3])
def test_threads_give_what_single_environments_give(name, threads):
    """Over episodes that end and begin; the table rests on MuJoCo's contacts, whose
    solver starts warm: it is lost by whoever keeps less than the whole state."""
    ours = make(name, max_episode_steps=EPISODE, threads=threads)
    theirs = make(name, max_episode_steps=EPISODE, vectorization_mode="sync")
    assert type(ours).__name__ == "ImpactVectorEnv"
    found = play(ours)
    assert_same(found, play(theirs))
    ends = [step for step, one in enumerate(found) if step and one[3].all()]
    # one step more, in which the next episode begins
    assert ends == [25, 51, 77]
    # the environments differ, and something happens
    assert (found[-1][0][0] != found[-1][0][1]).any()
    assert (found[10][0] != found[9][0]).any()


@pytest.mark.parametrize("name", IDS)
def test_processes_give_what_single_environments_give(name):
    options = {"max_episode_steps": EPISODE, "num_envs": 2}
    # threads of other tests do not survive a fork
    spawned = {"vectorization_mode": "async", "vector_kwargs": {"context": "spawn"}}
    found = play(make(name, **options, **spawned))
    assert_same(found, play(make(name, **options)))


@pytest.mark.parametrize("options", [{"contacts": "mujoco"}, {"restitution": 0.5}])
def test_options_of_the_model_are_those_of_single_environments(options):
    ours = make(IDS[0], **options)
    theirs = make(IDS[0], vectorization_mode="sync", **options)
    assert ours.single_observation_space == theirs.single_observation_space
    assert_same(play(ours), play(theirs))


def test_an_episode_is_as_long_as_that_of_single_environments():
    vector = make(IDS[0], num_envs=1)
    vector.reset(seed=0)
    for step in range(1, 502):
        truncated = vector.step(np.zeros((1, 1)))[3]
        assert truncated.item() == (step == 500)
    endless = make(IDS[0], num_envs=1, max_episode_steps=-1)
    endless.reset(seed=0)
    assert not any(endless.step(np.zeros((1, 1)))[3].item() for _ in range(510))


@pytest.mark.parametrize("name", IDS)
def test_spaces_are_those_of_single_environments(name):
    ours, theirs = make(name), make(name, vectorization_mode="sync")
    for space in ("observation_space", "action_space"):
        assert getattr(ours, space) == getattr(theirs, space)
        assert getattr(ours, f"single_{space}") == getattr(theirs, f"single_{space}")
    assert ours.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert ours.render() is None
    observation, _ = ours.reset(seed=0)
    assert observation in ours.observation_space
    names = gymnasium.make(name).unwrapped.observation_names
    assert ours.observation_names == names


def test_seeds_are_those_of_single_environments():
    """One for all, one each, or none: then random numbers go on."""
    ours, theirs = make(IDS[2]), make(IDS[2], vectorization_mode="sync")
    for seed in (5, [9, 2, 4], None, [None, 1, None]):
        observation, _ = ours.reset(seed=seed)
        np.testing.assert_array_equal(observation, theirs.reset(seed=seed)[0])
        assert ours.np_random_seed == theirs.np_random_seed
    states = [random.bit_generator.state for random in ours.np_random]
    assert states == [random.bit_generator.state for random in theirs.np_random]


def test_some_environments_can_begin_anew_alone():
    ours = make(IDS[0], max_episode_steps=EPISODE)
    theirs = make(IDS[0], max_episode_steps=EPISODE, vectorization_mode="sync")
    found = []
    for vector in (ours, theirs):
        seen = [vector.reset(seed=1)[0].copy()]
        for step, action in enumerate(actions(vector)):
            # in the middle, and when all are over
            if step in (10, EPISODE):
                options = {"reset_mask": np.array([False, True, False])}
                seen.append(vector.reset(options=options)[0].copy())
            seen += [one.copy() for one in vector.step(action)[:4]]
        found.append(seen)
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)


def test_what_was_returned_does_not_change_later():
    vector = make(IDS[0])
    vector.reset(seed=0)
    first = vector.step(actions(vector)[0])
    kept = copy.deepcopy(first)
    vector.step(actions(vector)[1])
    assert_same([first[:4]], [kept[:4]])


def test_a_simulation_that_breaks_down_is_named():
    vector = make(IDS[0])
    vector.reset(seed=0)
    vector._data.qvel[1, 0] = np.nan
    said = "mjWARN_BADQVEL in environment 1 by"
    with pytest.raises(SimulationError, match=said):
        vector.step(np.zeros((3, 1)))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"num_envs": 0}, "num_envs = 0: must be >= 1"),
        ({"max_episode_steps": 0}, "max_episode_steps = 0: must be >= 1, or -1"),
        ({"threads": 0}, "threads = 0: must be >= 1"),
        ({"render_mode": "human"}, "render_mode = 'human': allowed are None and"),
        ({"contacts": "soft"}, "contacts = 'soft': allowed are 'impact' and 'mujoco'"),
        ({"autoreset_mode": "SameStep"}, "autoreset_mode"),
    ],
)
def test_bad_options_are_refused_with_a_reason(options, said):
    with pytest.raises(ValueError, match=said):
        make(IDS[0], **options)


def test_bad_calls_are_refused_with_a_reason():
    vector = make(IDS[0])
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset before"):
        vector.step(np.zeros((3, 1)))
    with pytest.raises(ConfigError, match="seed has 2 numbers, but there are 3 env"):
        vector.reset(seed=[1, 2])
    for mask in ([True], np.zeros(3, dtype=bool), np.ones(3)):
        with pytest.raises(ConfigError, match=r"must be bool, shape \(3,\), one at"):
            vector.reset(options={"reset_mask": mask})
    vector.reset(seed=0)
    # numpy would give the action of one to all
    with pytest.raises(ConfigError, match=r"shape \(1, 1\), allowed: \(3, 1\)"):
        vector.step(np.zeros((1, 1)))
    vector.close()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="are closed"):
        vector.step(np.zeros((3, 1)))


def test_the_clock_of_mujoco_stands_still_while_they_step():
    """A fifth of the time of a step is reading it; afterwards it is as before."""
    vector, read = make(IDS[0]), []
    vector.reset(seed=0)
    clock = lambda: read.append(1) or 0.0  # noqa: E731
    mujoco.set_mjcb_time(clock)
    try:
        vector.step(np.zeros((3, 1)))
        assert mujoco.get_mjcb_time() is clock
        assert read == []
        single = gymnasium.make(IDS[0]).unwrapped
        single.reset(seed=0)
        assert read
    finally:
        mujoco.set_mjcb_time(None)


def test_a_frame_is_of_the_state_that_was_observed(monkeypatch):
    """Without OpenGL: what the camera is given."""
    seen = []
    monkeypatch.setattr(
        "mujoco_impact.envs.gym.Camera.picture",
        lambda _, data: seen.append([*data.qpos, *data.geom("ball_1").xpos]),
    )
    vector = make(IDS[0], render_mode="rgb_array")
    vector.reset(seed=0)
    observation = vector.step(np.ones((3, 1)))[0]
    assert len(vector.render()) == 3
    angles = observation[:, vector.observation_names["angles"]]
    np.testing.assert_array_equal(np.array(seen)[:, :5], angles)
    # geometry is of that state, too: balls swing on arms of 0.3 m, here to rounding
    x, swing = np.array(seen)[:, 5], 0.3 * np.sin(angles[:, 0])
    np.testing.assert_allclose(np.diff(x), np.diff(swing), atol=1e-15)
    assert np.diff(x).all()
