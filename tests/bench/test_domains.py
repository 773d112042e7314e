"""Domains of other libraries, stock beside ours: what docs/domains.md is made of."""

import dataclasses
import math

import mujoco
import numpy as np
import pytest

pytest.importorskip("dm_control")
pytest.importorskip("gymnasium")

from mujoco_impact_lab.domains.falls import ROBOTS, falls
from mujoco_impact_lab.domains.page import markdown
from mujoco_impact_lab.domains.scenes import DM_CONTROL, GYMNASIUM, Scene
from mujoco_impact_lab.domains.tours import tour
from mujoco_impact_lab.domains.watch import Watch

pytestmark = [
    # of the scenes of the libraries
    pytest.mark.filterwarnings("ignore:compiler attribute 'settotalmass'"),
    pytest.mark.filterwarnings("ignore:.*GLFWError"),
]

HUMANOID, QUADRUPED, WALKER, CHEETAH, DOG = ROBOTS


@pytest.mark.parametrize(
    ("robot", "seconds"), [(QUADRUPED, 3.0), (WALKER, 3.0), (CHEETAH, 3.0), (DOG, 0.6)]
)
def test_robots_fall_about_as_deep_as_with_mujoco_and_gain_no_energy(robot, seconds):
    ours, stock = falls(robot, restitution=0.5, seeds=1, seconds=seconds, samples=5)
    [fall], [other] = ours, stock
    assert fall.impacts > 5
    assert other.impacts == 0
    assert fall.warnings == 0
    # what carries bodies during an impact is not followed: its work is below this
    assert fall.energy_part < 1e-3
    # an impact turns back what MuJoCo lets sink in; the page has the worst of seeds
    assert fall.deepest < 1.2 * other.deepest
    assert fall.work > 0
    assert fall.costs is not None
    assert fall.costs.struck <= 1.0


def test_the_watch_finds_energy_that_an_impact_adds():
    """A record with twice the impulse of an elastic impact: p.v + p.(p/M)/2 > 0."""
    scene = WALKER
    player = scene.ours(1.0)
    player.reset(0)
    model, data = player.model, player.data
    found = []
    for factor in (1.0, 1.5):
        player.reset(0)
        watch = Watch(model, data, scene.stock().model)
        while not watch.impacts:
            watch.before_step()
            before = data.qpos.copy(), data.qvel.copy(), data.act.copy()
            mujoco.mj_step(model, data)
            watch.after_step()
        impact = dataclasses.replace(
            watch.recorded[-1], impulse=factor * watch.recorded[-1].impulse
        )
        watch.energy = 0.0
        watch.judge([impact], *before)
        found.append(watch.energy / watch.kinetic)
    assert found[0] < 1e-2
    assert found[1] > 0.1


@pytest.mark.parametrize(
    "scene",
    [
        Scene(DM_CONTROL, "finger", "spin"),
        Scene(DM_CONTROL, "hopper", "hop"),
        Scene(DM_CONTROL, "ball_in_cup", "catch"),
        Scene(GYMNASIUM, "Hopper-v5", ""),
        Scene(GYMNASIUM, "Pusher-v5", ""),
    ],
    ids=lambda scene: scene.name,
)
def test_an_environment_runs_without_a_warning(scene):
    found = tour(scene, actions=100)
    assert found.stock is not None
    assert found.ours is not None
    assert found.stock.warnings == 0
    assert found.ours.warnings == 0
    assert 0 < found.ours.fastest < 100


def test_a_domain_without_contacts_is_refused_in_one_sentence():
    found = tour(Scene(DM_CONTROL, "reacher", "easy"), actions=2)
    assert found.ours is None
    assert found.refusal == (
        'the scene has <flag contact="disable"/>: MuJoCo finds no contacts'
    )


def test_the_page_tells_more_warnings_and_refusals():
    scene = Scene(DM_CONTROL, "finger", "spin")
    found = tour(scene, actions=2)
    assert found.ours is not None
    worse = dataclasses.replace(found, ours=dataclasses.replace(found.ours, warnings=3))
    refused = tour(Scene(DM_CONTROL, "reacher", "easy"), actions=2)
    robots = {
        (CHEETAH.name, 0.5): falls(CHEETAH, restitution=0.5, seeds=1, seconds=0.1)
    }
    page = markdown(robots, [worse, refused], 1, 2)
    assert "More warnings than with MuJoCo's contacts: finger spin." in page
    assert "| 3 / 0 |" in page
    assert "MuJoCo finds no contacts`: reacher easy" in page
    assert "None warns" in markdown(robots, [found, refused], 1, 2)
    assert math.isfinite(
        np.sum([fall.deepest for fall in robots[CHEETAH.name, 0.5][0]])
    )
