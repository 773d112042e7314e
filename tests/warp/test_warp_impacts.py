"""Impacts beside MuJoCo Warp are those of the plugin."""

import mujoco
import numpy as np
import pytest
from worlds import TABLE, Worlds

import cradle_models
import mujoco_impact


def cradle(name, restitution):
    scene = cradle_models.model_path(name)
    return mujoco_impact.attach(scene, restitution=restitution).compile()


@pytest.mark.parametrize("restitution", [1.0, 0.9])
@pytest.mark.parametrize("name", ["row_3", "row_5", "paper_baa"])
def test_the_first_impact_of_a_row_is_that_of_the_plugin(name, restitution):
    worlds = Worlds(cradle(name, restitution))
    while worlds.impacts.impact_count[0] == 0:
        speed = np.abs(worlds.data.qvel).max()
        worlds.step_both()
    difference = np.abs(worlds.qvel[0] - worlds.data.qvel).max()
    # of the impact speed: rounding of single precision, 6e-7 here, 3e-5 is promised
    assert difference <= 3e-6 * speed
    # most of the momentum went through the row in this step
    assert worlds.qvel[0, -1] > 0.8 * speed


def test_three_seconds_of_five_balls_stay_with_the_plugin():
    worlds = Worlds(cradle("row_5", 1.0))
    # [rad] 8e-5 where an impact is in another step by rounding; a ball swings by .5
    assert worlds.step_both(1500) <= 1e-3
    assert worlds.impacts.impact_count[0] > 10


def test_a_world_has_the_same_bits_whatever_its_neighbours():
    model = cradle("row_3", 0.9)
    random = np.random.default_rng(0)
    # apart by some millimetres, and closing: all three meet within 20 steps
    qpos = np.sort(random.uniform(-0.01, 0.01, (1000, 3)), axis=1)
    qvel = -np.sort(random.uniform(-1, 1, (1000, 3)), axis=1)
    order = random.permutation(1000)
    together = Worlds(model, qpos=qpos, qvel=qvel)
    together.step(20)
    mixed = Worlds(model, qpos=qpos[order], qvel=qvel[order])
    mixed.step(20)
    assert (together.impacts.impact_count > 0).mean() > 0.9
    for name in ("qpos", "qvel"):
        np.testing.assert_array_equal(
            getattr(mixed, name), getattr(together, name)[order]
        )
    for world in range(0, 1000, 100):
        alone = Worlds(model, qpos=qpos[world], qvel=qvel[world])
        alone.step(20)
        np.testing.assert_array_equal(alone.qpos[0], together.qpos[world])
        np.testing.assert_array_equal(alone.qvel[0], together.qvel[world])


@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_free_balls_bounce_and_come_to_rest_on_a_plane(restitution):
    model = mujoco_impact.attach(TABLE, restitution=restitution).compile()
    worlds = Worlds(model, qvel=np.zeros(model.nv))
    # [m] rounding of places of .4 m, 3e-8, some hundred times by bounces off each other
    assert worlds.step_both(350) <= 3e-5
    assert worlds.impacts.impact_count[0] >= 4
    # the third has lain there all the time, carried by MuJoCo Warp
    assert np.abs(worlds.qvel[0, 12:15]).max() < 1e-4


def test_balls_that_overlap_and_still_close_are_not_pushed_twice():
    model = mujoco_impact.attach(TABLE, restitution=0.8).compile()
    qpos = model.qpos0.copy()
    # 50 µm deep in the table, and falling: MuJoCo's solver has a row for it
    qpos[2] = 0.05 - 5e-5
    qvel = np.zeros(model.nv)
    qvel[2] = -1.0
    worlds = Worlds(model, qpos=qpos, qvel=qvel)
    assert worlds.step_both(1) <= 1e-6
    # e times the speed, less gravity
    assert worlds.qvel[0, 2] == pytest.approx(0.8, abs=0.05)


def test_an_elastic_impact_keeps_the_energy_however_coarse_the_law():
    scene = cradle_models.model_path("row_5")
    model = mujoco_impact.attach(scene, tolerance=1e-2).compile()
    worlds = Worlds(model, qpos=np.zeros(5), qvel=np.array([2.0, 0, 0, 0, 0]))
    worlds.step()
    # equal balls at the bottom; gravity takes 1e-5, the law alone is off by 1e-3
    assert (worlds.qvel[0] ** 2).sum() == pytest.approx(4.0, rel=5e-5)
    assert worlds.impacts.impact_count[0] == 1


def test_a_ball_does_not_fly_through_another_within_a_step():
    model = mujoco_impact.attach(TABLE, restitution=1.0).compile()
    qpos = model.qpos0.copy()
    qpos[:3], qpos[7:10] = (0, 0, 0.5), (-0.11, 0, 0.5)
    qvel = np.zeros(model.nv)
    qvel[6] = 110.0
    worlds = Worlds(model, qpos=qpos, qvel=qvel)
    worlds.step()
    mass = model.body("a").mass[0] / model.body("b").mass[0]
    # 2 v / (1 + m_a/m_b), rounded
    assert worlds.qvel[0, 0] == pytest.approx(220 / (1 + mass), rel=1e-5)


SPRINGS = """<mujoco>
  <option timestep=".002" gravity="0 0 0"/>
  <default>
    <geom size=".05" condim="1"/>
    <joint type="slide" axis="1 0 0" damping=".3" stiffness="20"/>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 .1" pos=".5 0 0" zaxis="-1 0 0"/>
    <body pos="-.2 0 0"><joint/><geom/></body>
    <body><joint/><geom/></body>
    <body pos=".15 0 0"><joint/><geom/></body>
  </worldbody>
</mujoco>"""


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
def test_springs_and_dampers_act_on_as_with_the_plugin(integrator):
    spec = mujoco_impact.attach(SPRINGS, restitution=0.9)
    spec.option.integrator = getattr(
        mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}"
    )
    model = spec.compile()
    worlds = Worlds(model, qvel=np.array([2.0, 0.0, 0.0]))
    # [m] rounding of .2 m, 1e-8; without damping of the impulses it is 1e-3
    assert worlds.step_both(200) <= 1e-6
    assert worlds.impacts.impact_count[0] >= 2


def test_a_world_without_gravity_rests_as_a_model_without_gravity():
    # two balls that a spring presses on each other, across gravity
    scene = SPRINGS.replace("<joint/>", '<joint springref=".2"/>', 1)
    down = scene.replace('gravity="0 0 0"', 'gravity="0 0 -9.81"')
    worlds = [
        Worlds(mujoco_impact.attach(xml, restitution=0.5).compile(), qvel=np.zeros(3))
        for xml in (scene, down)
    ]
    worlds[1].m.opt.gravity.zero_()
    for of_model in worlds:
        of_model.step(300)
    none, zeroed = worlds
    assert zeroed.impacts.impact_count[0] == none.impacts.impact_count[0] > 2
    np.testing.assert_array_equal(zeroed.qpos, none.qpos)


def test_each_instance_has_its_own_restitution():
    # b meets nothing, and the others only the table
    scene = mujoco.MjSpec.from_string(TABLE)
    scene.geom("b").contype = scene.geom("b").conaffinity = 0
    for name, bit in (("a", 1), ("c", 2)):
        scene.geom(name).contype = bit
        scene.geom(name).conaffinity = 0
    scene.geom("table").contype = 0
    scene.geom("table").conaffinity = 3
    spec = mujoco_impact.attach(scene, geoms=["a"], name="soft", restitution=0.3)
    spec = mujoco_impact.attach(spec, geoms=["c"], name="hard", restitution=0.9)
    model = spec.compile()
    qpos = model.qpos0.copy()
    qpos[2] = qpos[14 + 2] = 0.06
    worlds = Worlds(model, qpos=qpos, qvel=np.zeros(model.nv))
    # [m] rounding of places of .5 m
    assert worlds.step_both(30) <= 1e-6
    # both fell by 1 cm
    fall = np.sqrt(2 * 9.81 * 0.01)
    assert worlds.impacts.impact_count[0] >= 2
    assert worlds.qvel[0, 14] > 0.5 * fall
