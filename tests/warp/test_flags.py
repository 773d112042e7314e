"""Nothing that goes wrong on a device goes unnoticed."""

import mujoco_warp
import numpy as np
import pytest
import warp as wp
from worlds import TABLE, Worlds

import cradle_models
import mujoco_impact
from mujoco_impact import warp


@pytest.fixture(scope="module")
def model():
    scene = cradle_models.model_path("row_3")
    return mujoco_impact.attach(scene, restitution=0.9).compile()


def struck(model, **options):
    """Returns three worlds, of which the middle one has an impact in its first step."""
    qvel = np.zeros((3, 3))
    qvel[1, 0] = 1.0
    return Worlds(model, qpos=np.zeros(3), qvel=qvel, **options)


def test_an_impact_of_more_contacts_than_there_is_room_for_is_an_error(model):
    worlds = struck(model, contacts=1)
    with pytest.raises(
        mujoco_impact.ImpactError, match="more than 1 contacts"
    ) as error:
        worlds.step()
    assert "in world 1" in str(error.value)


def test_an_impact_beyond_its_budget_is_an_error(model):
    worlds = struck(model, law_steps=10)
    with pytest.raises(
        mujoco_impact.ImpactError, match="more than 10 steps of the law"
    ):
        worlds.step()
    # the next step says it, too, without being asked
    with pytest.raises(mujoco_impact.ImpactError, match="in world 1"):
        warp.step(worlds.m, worlds.d, worlds.impacts)
    worlds.impacts.reset()
    worlds.d.qvel.zero_()
    worlds.step()


def replayed(worlds):
    """Captures a step in a graph, and runs it from the state before."""
    qvel = worlds.qvel.copy()
    with wp.ScopedCapture() as capture:
        warp.step(worlds.m, worlds.d, worlds.impacts)
    # to capture is not to run
    np.testing.assert_array_equal(worlds.qvel, qvel)
    wp.capture_launch(capture.graph)
    return worlds


def test_a_step_in_a_graph_is_a_step(model):
    worlds = struck(model)
    worlds.step()
    graph = replayed(struck(model))
    np.testing.assert_array_equal(graph.qvel, worlds.qvel)
    assert graph.qvel[1, 2] > 0.8


def test_what_goes_wrong_in_a_graph_is_kept_until_it_is_asked_for(model):
    worlds = replayed(struck(model, law_steps=10))
    with pytest.raises(mujoco_impact.ImpactError, match="in world 1"):
        worlds.impacts.check()


def test_an_impact_cut_short_gains_no_energy(model):
    worlds = struck(model, law_steps=10)
    with pytest.raises(mujoco_impact.ImpactError):
        worlds.step()
    # equal balls on equal arms
    assert (worlds.qvel[1] ** 2).sum() <= 1.0


def test_the_step_of_mujoco_warp_refuses_a_model_whose_impacts_are_ours(model):
    worlds = struck(model)
    with pytest.raises(mujoco_impact.ImpactError, match=r"mujoco_impact\.warp\.step"):
        mujoco_warp.step(worlds.m, worlds.d)


def test_model_data_and_impacts_must_belong_together(model):
    worlds = struck(model)
    others = warp.put_impacts(model, nworld=2)
    with pytest.raises(mujoco_impact.ImpactError, match="impacts are of 2 worlds"):
        warp.step(worlds.m, worlds.d, others)
    plain = mujoco_warp.put_model(mujoco_impact.detach(TABLE).compile())
    with pytest.raises(mujoco_impact.ImpactError, match="not one of mujoco_impact"):
        warp.step(plain, worlds.d, worlds.impacts)


def test_impacts_of_another_model_of_the_same_size_are_refused(model):
    worlds = struck(model)
    scene = cradle_models.model_path("row_3")
    softer = mujoco_impact.attach(scene, restitution=0.5).compile()
    others = warp.put_impacts(softer, nworld=3)
    with pytest.raises(mujoco_impact.ImpactError, match="of another model"):
        warp.step(worlds.m, worlds.d, others)
    same = mujoco_impact.attach(scene, restitution=0.9).compile()
    warp.step(worlds.m, worlds.d, warp.put_impacts(same, nworld=3))


@pytest.mark.parametrize(
    "name",
    [
        "body_inertia",
        "body_mass",
        "body_subtreemass",
        "dof_frictionloss",
        "geom_friction",
        "geom_gap",
        "geom_quat",
        "jnt_range",
        "qpos0",
    ],
)
def test_values_of_the_model_that_differ_by_world_are_refused(model, name):
    worlds = struck(model)
    m = warp.put_model(model, batch_sizes={name: 3})
    with pytest.raises(
        mujoco_impact.ImpactError, match=f"{name} that differs by world"
    ):
        warp.step(m, worlds.d, worlds.impacts)


def test_looks_the_solver_and_options_may_differ_by_world(model):
    worlds = struck(model)
    names = ("geom_rgba", "geom_solref", "cam_fovy", "body_invweight0")
    m = warp.put_model(model, batch_sizes=dict.fromkeys(names, 3))
    m.opt.timestep = wp.array([0.001, 0.002, 0.003], dtype=float)
    # [m/s²] none in the last world, whose resting balls stay as they are
    m.opt.gravity = wp.array([[0, 0, -9.81], [0, 0, -9.81], [0, 0, 0]], dtype=wp.vec3)
    warp.step(m, worlds.d, worlds.impacts)
    assert worlds.impacts.impact_count.tolist() == [0, 1, 0]


def test_the_sensor_reads_no_number_that_could_be_taken_for_one(model):
    worlds = struck(model)
    worlds.step()
    assert np.isnan(worlds.d.sensordata.numpy()).all()
    assert worlds.impacts.impact_count.tolist() == [0, 1, 0]


def test_memory_of_a_world_is_told(model):
    few = warp.put_impacts(model, nworld=1).bytes_per_world
    assert few == warp.put_impacts(model, nworld=50).bytes_per_world
    # [B] three balls
    assert 100 < few < 1000
