"""The composer entity: what it observes is what the plugin computed."""

import numpy as np
import pytest

pytest.importorskip("dm_control")
from composer_task import environment
from dm_control import composer

import cradle_models
from mujoco_impact.envs import Cradle

NAMES = ("angles", "speeds", "force", "impulse", "peak_force", "alpha",
         "impact_count", "force_waveform")  # fmt: skip
RATE = 40_000


def steps(env, action=0.0):
    step = env.reset()
    while not step.last():
        step = env.step(np.array([action]))
        yield step.observation


def test_every_observable_has_the_shape_it_says():
    env = environment(pattern="ABAB")
    observation = env.reset().observation
    shapes = {name: observation[f"cradle/{name}"].shape for name in NAMES}
    assert shapes == {
        "angles": (4,),
        "speeds": (4,),
        "force": (4, 3),
        "impulse": (4,),
        "peak_force": (4,),
        "alpha": (4,),
        "impact_count": (4,),
        "force_waveform": (800, 3),
    }
    assert set(observation) == {f"cradle/{name}" for name in NAMES}


@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_the_waveform_adds_up_to_the_impulse_of_the_sensor(duration):
    """First impact of a row: the end balls have one contact, the others two."""
    env = environment(pattern="ABA", duration=duration, time_limit=0.4)
    delivered = np.zeros(2)
    for observation in steps(env):
        delivered += observation["cradle/force_waveform"].sum(axis=0) / RATE
        if observation["cradle/impact_count"].max() > 2:
            pytest.fail("a second impact came before the first was over")
    impulse = observation["cradle/impulse"]
    np.testing.assert_array_equal(observation["cradle/impact_count"], [1, 2, 1])
    np.testing.assert_allclose(delivered, impulse[[0, 2]], rtol=1e-9)
    # the middle ball reports one of its two
    assert np.abs(delivered / impulse[1] - 1).min() < 1e-9


def test_the_peak_of_the_waveform_is_the_peak_force():
    env = environment(pattern="AA", duration=7.5e-3, time_limit=0.4)
    largest = max(o["cradle/force_waveform"].max() for o in steps(env))
    peak = next(reversed(list(steps(env))))["cradle/peak_force"][0]
    # averages over 25 us of a half sine of 7.5 ms: 1 - (pi 25e-6 / 7.5e-3)²/24
    assert largest == pytest.approx(peak, rel=1e-5)


def test_force_times_timestep_is_the_change_of_momentum():
    """`force` of every physics step, by a buffer of one control step."""
    env = environment(pattern="AA", control_timestep=0.002, time_limit=0.4)
    impulse = 0.0
    for observation in steps(env):
        force = observation["cradle/force"]
        np.testing.assert_array_equal(force[0], -force[1])
        impulse += force[1] * 0.002
    assert impulse[0] == pytest.approx(observation["cradle/impulse"][1], rel=1e-9)


def test_an_episode_forgets_the_one_before():
    env = environment(time_limit=0.5)
    first = [o["cradle/force_waveform"] for o in steps(env)]
    again = [o["cradle/force_waveform"] for o in steps(env)]
    assert np.max(first) > 100
    np.testing.assert_array_equal(first, again)


def test_a_cradle_takes_materials_law_and_balls():
    balls = [cradle_models.Ball(0.2, 0.018), cradle_models.Ball(0.1, 0.012)]
    env = environment(pattern=balls, restitution=0.5, young=7e10, time_limit=0.4)
    env.reset()
    physics = env.physics
    bodies = [ball.parent for ball in env.task.cradle.balls]
    assert list(physics.bind(bodies).mass) == [0.2, 0.1]
    # e of a pair, from the motion: speed apart over speed together
    before, after = None, None
    for observation in steps(env):
        speeds = observation["cradle/speeds"]
        if observation["cradle/impact_count"][0] == 0:
            before = speeds[0] - speeds[1]
        elif after is None:
            after = speeds[1] - speeds[0]
    # the arms are as long, so angular speeds will do; a control step of the swing
    # lies between
    assert after / before == pytest.approx(0.5, abs=0.02)


def test_two_cradles_in_one_arena_report_their_own_impacts():
    class Two(composer.Task):
        def __init__(self):
            self._arena = composer.Arena()
            self.rows = [Cradle(pattern="AAA", name=name) for name in ("left", "right")]
            for place, row in enumerate(self.rows):
                self._arena.attach(row).pos = [0.0, 0.2 * place, 0.0]
                row.observables.enable_all()
            self.set_timesteps(0.02, 0.002)

        @property
        def root_entity(self):
            return self._arena

        def initialize_episode(self, physics, random_state):  # noqa: ARG002
            self.rows[0].set_angles(physics, [-0.3, 0.0, 0.0])

        def get_reward(self, physics):  # noqa: ARG002
            return 0.0

    env = composer.Environment(
        Two(), legacy_step=False, strip_singleton_obs_buffer_dim=True
    )
    env.reset()
    total = np.zeros((2, 2))
    for _ in range(20):
        observation = env.step(np.zeros(0)).observation
        for place, name in enumerate(("left", "right")):
            total[place] += observation[f"{name}/force_waveform"].sum(axis=0)
    assert list(observation["left/impact_count"]) == [1, 2, 1]
    assert list(observation["right/impact_count"]) == [0, 0, 0]
    assert (total[0] > 0).all()
    assert (total[1] == 0).all()
