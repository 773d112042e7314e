"""The bank shot: what scores, that it can be solved, and that chance does not."""

import math

import mujoco
import numpy as np
import pytest

from mujoco_impact.envs import ALL_TASKS, bank_model
from mujoco_impact.envs.billiards import (
    CUE_SPOT,
    HIGHEST_SPOT,
    LARGEST_AIM,
    LOWEST_SPOT,
    POCKET,
    RADIUS,
    WIDTH,
    BankShot,
)
from mujoco_impact.envs.games import GAMES
from mujoco_impact.envs.tasks import split
from mujoco_impact.errors import ConfigError

AIMED = 0.6
"""When the cue has turned and stands still [s]."""


class Table:
    """The task as any library plays it: actions for control steps of 20 ms."""

    def __init__(self, **options):
        self.model, self.task = GAMES["billiards", "bank"](**options)
        self.data = mujoco.MjData(self.model)

    def start(self, seed: int) -> None:
        mujoco.mj_resetData(self.model, self.data)
        self.task.begin(self.data, np.random.default_rng(seed))
        mujoco.mj_forward(self.model, self.data)

    def step(self, action) -> float:
        self.data.ctrl[:] = action
        mujoco.mj_step(self.model, self.data, nstep=10)
        self.task.after_step(self.data)
        return self.task.reward()

    def shoot(self, seed: int, angle: float) -> float:
        """Aims, waits, strikes with all force; returns the reward after 2.5 s."""
        self.start(seed)
        reward = 0.0
        while self.data.time < 2.5 and reward < 1.0:
            stroke = float(self.data.time > AIMED)
            reward = self.step([angle / LARGEST_AIM, stroke])
        return reward

    def object_ball(self) -> np.ndarray:
        return self.data.body("ball_1").xpos.copy()


def computed_aim(table: Table, seed: int) -> float:
    """The best angle around the line of centres: a grid, and a finer one within."""
    table.start(seed)
    way = table.object_ball()[:2] - CUE_SPOT
    angle, width = -math.atan2(way[0], way[1]), 0.08
    for _ in range(3):
        grid = np.linspace(angle - width, angle + width, 17)
        angle = max(grid, key=lambda one: table.shoot(seed, one))
        width /= 8
        if table.shoot(seed, angle) == 1.0:
            break
    return angle


@pytest.fixture(scope="module")
def table() -> Table:
    return Table()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_computed_shot_pockets_the_ball_and_scores(table, seed):
    angle = computed_aim(table, seed)
    table.start(seed)
    rewards = [
        table.step([angle / LARGEST_AIM, float(table.data.time > AIMED)])
        for _ in range(500)
    ]
    assert rewards[-1] == 1.0
    # it is in after 2 s of 10
    assert sum(rewards) > 390
    place = table.object_ball()
    assert place[2] < -RADIUS
    assert not table.data.warning.number.any()


def test_random_actions_mostly_do_not_score(table):
    rng, scored = np.random.default_rng(0), []
    for seed in range(10):
        table.start(seed)
        for _ in range(250):
            reward = table.step(rng.uniform(-1, 1, 2))
            assert 0.0 <= reward <= 1.0
        scored.append(reward)
    assert np.mean(scored) < 0.1
    assert max(scored) < 1.0


def test_the_shot_needs_the_bank(table):
    """A ball that goes straight into the pocket scores nothing."""
    table.start(0)
    joint = table.data.joint("free_ball_1")
    joint.qpos[:2] = POCKET[0], POCKET[1] + 0.2
    joint.qvel[:2] = 0.0, -1.0
    rewards = [table.step([0.0, 0.0]) for _ in range(75)]
    assert table.object_ball()[2] < -RADIUS
    assert not any(rewards)


def test_it_scores_by_how_near_the_ball_has_come_since_the_bank(table):
    table.start(0)
    joint = table.data.joint("free_ball_1")
    joint.qpos[:2] = 0.3, WIDTH / 2 - 0.1
    joint.qvel[:2] = 0.0, 1.0
    rewards, distances = [], []
    for _ in range(150):
        rewards.append(table.step([0.0, 0.0]))
        distances.append(math.hypot(*(table.object_ball()[:2] - POCKET)))
    # 0 until it comes back, and it never gets worse
    assert rewards[0] == 0.0
    assert 0.0 < rewards[-1] < 0.5
    assert (np.diff(rewards) >= 0).all()
    # a tenth of the half at half a metre
    nearest = min(distances[20:])
    assert rewards[-1] == pytest.approx(0.5 * 0.1 ** (nearest / 0.5) ** 2, rel=1e-2)


def test_the_start_is_drawn_within_its_bounds(table):
    places = []
    for seed in range(50):
        table.start(seed)
        places.append([*table.object_ball()[:2], table.data.joint("aim").qpos[0]])
    low, high = np.min(places, axis=0), np.max(places, axis=0)
    assert (low >= [*LOWEST_SPOT, -0.1]).all()
    assert (high <= [*HIGHEST_SPOT, 0.1]).all()
    # fifty draws fill four fifths of a range
    assert ((high - low)[:2] > 0.8 * np.subtract(HIGHEST_SPOT, LOWEST_SPOT)).all()


def test_the_tip_touches_the_cue_ball_alone():
    model = bank_model()
    tip, touched = model.geom("tip"), []
    for number in range(model.ngeom):
        one = model.geom(number)
        if (tip.contype & one.conaffinity) or (one.contype & tip.conaffinity):
            touched.append(one.name)
    assert touched == ["cue"]


def test_contacts_can_be_those_of_mujoco():
    table = Table(contacts="mujoco")
    assert table.model.nplugin == 0
    assert "impulses" not in table.task.bounds()
    with pytest.raises(ConfigError, match="takes no settings, got restitution"):
        bank_model(contacts="mujoco", restitution=0.5)


def test_observations_are_as_their_bounds_say(table):
    assert isinstance(table.task, BankShot)
    assert ("billiards", "bank") in ALL_TASKS
    table.start(0)
    for _ in range(60):
        table.step([0.2, 1.0])
    found, bounds = table.task.observation(table.data), table.task.bounds()
    assert found.shape == (sum(one.size for one in bounds.values()),)
    seen = {name: found[where] for name, where in split(bounds).items()}
    for name, value in seen.items():
        assert value.shape == (bounds[name].size,)
        assert (value >= bounds[name].low).all()
        assert (value <= bounds[name].high).all()
    # the tip, the cue ball and the object ball, if they were struck
    assert (seen["impulses"][:2] > 0).all()
