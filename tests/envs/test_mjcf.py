"""Our contacts for PyMJCF models: the same bits as for an MjSpec."""

import mujoco
import numpy as np
import pytest

pytest.importorskip("dm_control")
from dm_control import mjcf

import cradle_models
import mujoco_impact
from mujoco_impact.envs import attach_mjcf
from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.sensor import read_sensor


def physics_of(root):
    physics = mjcf.Physics.from_mjcf_model(root)
    physics.legacy_step = False
    return physics


def test_a_pymjcf_model_moves_as_the_same_mjspec_bit_for_bit():
    xml = cradle_models.row("ABA")
    root = mjcf.from_xml_string(xml)
    sensor = attach_mjcf(root, restitution=0.9, young=70e9)
    physics = physics_of(root)
    model = mujoco_impact.attach(xml, restitution=0.9, young=70e9).compile()
    data = mujoco.MjData(model)
    physics.data.qpos[0] = data.qpos[0] = -0.4
    for _ in range(500):
        physics.step()
        mujoco.mj_step(model, data)
    np.testing.assert_array_equal(physics.data.qpos, data.qpos)
    np.testing.assert_array_equal(physics.data.plugin_state, data.plugin_state)
    counts = read_sensor(np.asarray(physics.bind(sensor).sensordata)).count
    assert counts[1] >= 2


def test_materials_of_a_pymjcf_model_are_those_of_the_mjspec():
    xml = cradle_models.row("ABA")
    options = {
        "materials": {"worn": {"restitution": 0.7}},
        "assign": {"ball_1": "steel", "ball_2": "worn"},
        "pairs": {("ball_2", "ball_3"): {"restitution": 0.5}},
    }
    root = mjcf.from_xml_string(xml)
    attach_mjcf(root, **options)
    physics = physics_of(root)
    model = mujoco_impact.attach(xml, **options).compile()
    data = mujoco.MjData(model)
    physics.data.qpos[0] = data.qpos[0] = -0.4
    for _ in range(300):
        physics.step()
        mujoco.mj_step(model, data)
    assert data.plugin_state[1] >= 2  # impacts
    np.testing.assert_array_equal(physics.data.qpos, data.qpos)


def two_rows():
    """An arena with two rows; names of the one occur in the other, too."""
    arena = mjcf.RootElement(model="arena")
    for index in range(2):
        row = mjcf.from_xml_string(cradle_models.row("AAA", name=f"row_{index}"))
        row.find("key", "release").remove()
        arena.attach(row).pos = [0.0, 0.2 * index, 0.0]
    return arena


def test_a_model_made_of_others_is_owned_whole():
    arena = two_rows()
    sensor = attach_mjcf(arena)
    physics = physics_of(arena)
    physics.data.qpos[[0, 3]] = -0.3
    physics.step(300)
    reading = read_sensor(np.asarray(physics.bind(sensor).sensordata))
    np.testing.assert_array_equal(reading.count, [1, 2, 1] * 2)
    np.testing.assert_array_equal(reading.impulse[:3], reading.impulse[3:])


def test_only_the_geoms_asked_for_are_owned():
    arena = two_rows()
    geoms = arena.find_all("geom")[3:]
    sensor = attach_mjcf(arena, geoms=geoms)
    assert [geom.margin for geom in arena.find_all("geom")[:3]] == [None] * 3
    physics = physics_of(arena)
    physics.data.qpos[[0, 3]] = -0.3
    physics.step(150)
    assert physics.bind(sensor).sensordata.shape == (33,)
    # -.071 of the speed is Hertz; MuJoCo's contacts leave ball 1 with a push forward
    assert physics.data.qvel[3] < 0 < physics.data.qvel[0]


def test_a_model_that_was_given_the_plugin_can_be_attached_to_others():
    arena = mjcf.RootElement(model="arena")
    sensors = []
    for index in range(2):
        row = mjcf.from_xml_string(cradle_models.row("AAA", name=f"row_{index}"))
        row.find("key", "release").remove()
        sensors.append(attach_mjcf(row))
        arena.attach(row).pos = [0.0, 0.2 * index, 0.0]
    physics = physics_of(arena)
    physics.data.qpos[[0, 3]] = -0.3
    physics.step(300)
    for sensor in sensors:
        # the plugin leaves room for the tuples of all instances
        reading = read_sensor(np.asarray(physics.bind(sensor).sensordata)[:33])
        np.testing.assert_array_equal(reading.count, [1, 2, 1])


def test_pairs_between_models_and_unnamed_geoms_are_taken_over():
    root = mjcf.from_xml_string(cradle_models.row("AA"))
    root.find("key", "release").remove()
    root.find("geom", "ball_1").remove()
    body = root.find("body", "ball_1")
    ball = body.add("geom", size=[0.015], mass=0.115, pos=[0, 0, -0.3])
    ball.name = "own"
    partner = root.find("geom", "ball_2")
    root.contact.add("pair", geom1=ball, geom2=partner, condim=1)
    post = root.worldbody.add("body", name="post", pos=[1, 0, 0])
    post.add("freejoint")
    post.add("geom", size=[0.01])
    sensor = attach_mjcf(root)
    assert root.find_all("contact")[0].margin < 0
    assert post.find_all("geom")[0].name
    physics = physics_of(root)
    physics.data.qpos[0] = -0.3
    physics.step(300)
    reading = read_sensor(np.asarray(physics.bind(sensor).sensordata))
    assert list(reading.count) == [1, 1, 0]


def test_what_cannot_be_owned_is_refused_with_a_reason():
    root = mjcf.from_xml_string(cradle_models.row("AA"))
    with pytest.raises(SceneError, match="there is no geom 'ball_9'"):
        attach_mjcf(root, geoms=["ball_9"])
    with pytest.raises(ConfigError, match="did you mean 'restitution'"):
        attach_mjcf(root, restitutoin=1)
    attach_mjcf(root)
    with pytest.raises(SceneError, match="already has a plugin instance 'impact'"):
        attach_mjcf(root)


def test_an_instance_that_nothing_names_is_seen():
    """MuJoCo's copy would leave it out, and a second one would be added."""
    root = mjcf.from_xml_string(cradle_models.row("AA"))
    plugin = root.extension.add("plugin", plugin="mujoco_impact.waveform")
    plugin.add("instance", name="mine")
    with pytest.raises(SceneError, match="'mine' of the scene already owns"):
        attach_mjcf(root)
