"""Domains that are not ours, with our contacts by one call, beside the stock ones."""

import numpy as np
import pytest

pytest.importorskip("dm_control")
from dm_control import suite

from mujoco_impact import envs
from mujoco_impact.errors import SceneError
from mujoco_impact.pulses import PulseReader

# quadruped and humanoid have force sensors, blind to our impacts: `attach` says so
pytestmark = pytest.mark.filterwarnings("ignore:MuJoCo's sensors do not see")


def pair(domain, task, **options):
    """The environment with our contacts, and the stock one, just reset."""
    kwargs = {"random": 0}
    ours = envs.load(domain, task, task_kwargs=kwargs, **options)
    stock = suite.load(
        domain,
        task,
        task_kwargs=kwargs,
        environment_kwargs={"legacy_step": False},
    )
    ours.reset()
    stock.reset()
    return ours, stock


def drop(environment, body, height, steps):
    """Heights of a free body that falls from rest, after each physics step [m]."""
    physics = environment.physics
    with physics.reset_context():
        joint = physics.model.body(body).jntadr[0]
        start = physics.model.jnt_qposadr[joint]
        physics.data.qpos[start : start + 7] = [3.0, 3.0, height, 1.0, 0.0, 0.0, 0.0]
        physics.data.qvel[:] = 0.0
    heights = np.zeros(steps)
    for step in range(steps):
        physics.step()
        heights[step] = physics.data.qpos[start + 2]
    return heights


@pytest.mark.parametrize(
    ("domain", "task", "options"),
    [
        ("quadruped", "fetch", {}),
        ("humanoid", "stand", {}),
        ("ball_in_cup", "catch", {}),
        ("quadruped", "fetch", {"geoms": ["ball"], "restitution": 0.8}),
    ],
)
def test_an_episode_starts_as_the_stock_one_and_has_its_interface(
    domain, task, options
):
    """Also where the task looks for a start without contacts, which ours would be."""
    ours, stock = pair(domain, task, **options)
    np.testing.assert_array_equal(ours.physics.data.qpos, stock.physics.data.qpos)
    np.testing.assert_array_equal(ours.physics.data.qvel, stock.physics.data.qvel)
    assert ours.observation_spec() == stock.observation_spec()
    assert ours.action_spec() == stock.action_spec()
    # and the margins of our contacts are back
    assert (ours.physics.model.geom_margin < 0).any()
    assert not (stock.physics.model.geom_margin < 0).any()


def test_the_ball_of_the_quadruped_bounces_by_the_restitution_set():
    """The rebound is e² of the height; stock contacts give another one."""
    ours, stock = pair("quadruped", "fetch", geoms=["ball"], restitution=0.8)
    radius = float(ours.physics.model.geom("ball").size[0])
    model = ours.physics.model
    assert model.opt.density == 0, "the fall is free"
    height = 1.0
    paths = [drop(env, "ball", radius + height, 250) for env in (ours, stock)]
    touch = int(np.argmin(paths[1] > radius + 0.05))
    # the same bits until something touches
    np.testing.assert_array_equal(paths[0][:touch], paths[1][:touch])
    rebounds = [path[int(np.argmin(path)) :].max() - radius for path in paths]
    # the timestep is 5 ms: the top is met to g h²/8, the fall ends to g h² high
    assert rebounds[0] == pytest.approx(0.64 * height, rel=2e-3)
    assert abs(rebounds[1] - 0.64 * height) > 0.1 * height


def test_the_humanoid_falls_as_the_stock_one_until_it_touches_and_comes_to_lie():
    ours, stock = pair("humanoid", "stand", restitution=0.2)
    reader = PulseReader(ours.physics.model.ptr, ours.physics.data.ptr)
    together = 0
    while not reader.impacts:
        np.testing.assert_array_equal(ours.physics.data.qpos, stock.physics.data.qpos)
        together += 1
        for environment in (ours, stock):
            environment.physics.step()
        reader.poll()
    assert together > 10
    action = np.zeros(ours.action_spec().shape)
    for _ in range(120):
        rewards = [env.step(action).reward for env in (ours, stock)]
        reader.poll()
    assert all(0.0 <= reward <= 1.0 for reward in rewards)
    assert len(reader.impacts) > 10
    # 3 s later both lie on the floor: no body is higher than a torso is thick, and
    # none has sunk below the floor
    for environment in (ours, stock):
        heights = environment.physics.data.xpos[1:, 2]
        assert 0.0 < heights.min() < heights.max() < 0.5


def test_two_episodes_of_one_seed_are_the_same():
    runs = []
    for _ in range(2):
        environment, _ = pair("quadruped", "fetch", geoms=["ball"])
        action = np.full(environment.action_spec().shape, 0.3)
        runs.append([environment.step(action).reward for _ in range(20)])
        runs[-1].extend(environment.physics.data.qpos)
    assert runs[0] == runs[1]


def test_the_sensor_comes_last_if_it_is_asked_for():
    ours, stock = pair("ball_in_cup", "catch", sensor=True)
    assert ours.physics.model.nsensor == stock.physics.model.nsensor + 1
    assert ours.physics.model.sensor(ours.physics.model.nsensor - 1).name == "impact"


@pytest.mark.parametrize(
    ("domain", "task", "options", "said"),
    [
        ("cradel", "strike", {}, "there is no domain 'cradel' .available: cradle, "),
        ("cradle", "hit", {}, "there is no task 'hit' .available: strike, damp, sel"),
        ("humanoid", "fly", {}, "there is no task 'fly' .available: stand, walk, run"),
        ("cradle", "damp", {"geoms": ["a"]}, "'cradle' has no option 'geoms'"),
        ("pendulum", "swingup", {}, "contact=.disable..*finds no contacts"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(domain, task, options, said):
    with pytest.raises(SceneError, match=said):
        envs.load(domain, task, **options)


def test_the_stock_suite_is_left_as_it_was():
    envs.load("ball_in_cup", "catch")
    stock = suite.load("ball_in_cup", "catch")
    assert stock.physics.model.nplugin == 0
