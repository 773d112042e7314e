"""What impacts on Warp do not support is refused by name, before anything is put."""

import ctypes

import mujoco
import pytest

import cradle_models
import mujoco_impact
from mujoco_impact import warp
from mujoco_impact.warp.settings import _Layout

SCENE = """<mujoco>
  <option timestep=".002" {option}/>
  <default><geom size=".05" condim="1"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    {world}
    <body name="ball" pos="0 0 .2" {body}>
      {joint}<geom name="ball" {geom}/>{inside}
    </body>
  </worldbody>
  {outside}
</mujoco>"""

FREE = "<freejoint/>"
HINGE = '<joint name="j" axis="0 1 0" pos="0 0 .3" {}/>'


def scene(*, option="", world="", body="", joint=FREE, geom="", inside="", outside=""):
    return SCENE.format(
        option=option,
        world=world,
        body=body,
        joint=joint,
        geom=geom,
        inside=inside,
        outside=outside,
    )


def refusal(xml, **settings):
    model = mujoco_impact.attach(xml, **settings).compile()
    with pytest.raises(mujoco_impact.errors.SceneError) as error:
        warp.put_impacts(model, nworld=1)
    # the model is not taken either
    with pytest.raises(mujoco_impact.errors.SceneError):
        warp.put_model(model)
    return str(error.value)


@pytest.mark.parametrize(
    ("said", "settings"),
    [
        ("dissipation = 'viscous'", {"dissipation": "viscous", "restitution": 0.5}),
        ("duration other than 'hertz'", {"duration": 0.01}),
        ("passive = 'false'", {"passive": False}),
        ("tolerance = 1e-09 below 1e-06", {"tolerance": 1e-9}),
        ("materials", {"assign": {"ball": "rubber"}}),
        ("pulses that last: a contact of 'floor' and 'ball'", {"young": 1e4}),
    ],
)
def test_settings(said, settings):
    assert f"does not support {said}" in refusal(scene(), **settings)


@pytest.mark.parametrize(
    ("said", "parts"),
    [
        ("the integrator rk4", {"option": 'integrator="RK4"'}),
        ("the box 'ball'", {"geom": 'type="box" size=".1 .1 .1"'}),
        ("the friction of 'floor' and 'ball'", {"geom": 'condim="3"'}),
        ("the ball joint of the geom 'ball'", {"joint": '<joint type="ball"/>'}),
        ("a limit on the joint", {"joint": HINGE.format('range="-30 30"')}),
        ("dry friction on the joint", {"joint": HINGE.format('frictionloss="1"')}),
        ("gravity compensation on the joint", {"body": 'gravcomp=".5"'}),
        ("the free body of the geom 'ball'", {"geom": 'pos="0 0 .01"'}),
        (
            "the chain of joints of the geom 'ball'",
            {"joint": '<joint type="slide"/><joint axis="0 1 0" pos="0 0 .3"/>'},
        ),
        (
            "two geoms of one body",
            {"joint": '<joint type="slide"/>', "inside": '<geom pos=".2 0 0"/>'},
        ),
        (
            "the mocap body of the geom 'hand'",
            {"world": '<body mocap="true" pos="1 0 1"><geom name="hand"/></body>'},
        ),
        (
            "the box 'wall'",
            {"world": '<geom name="wall" type="box" size=".1 .1 .1" pos="1 0 0"/>'},
        ),
        (
            "the equality constraint 'rope' on the body of the geom 'ball'",
            {
                "outside": '<equality><connect name="rope" body1="ball" '
                'anchor="0 0 0"/></equality>'
            },
        ),
        (
            "the explicit contact pair of 'floor' and 'ball'",
            {
                "outside": '<contact><pair geom1="floor" geom2="ball" condim="1"/>'
                "</contact>"
            },
        ),
    ],
)
def test_scenes(said, parts):
    assert f"does not support {said}" in refusal(scene(**parts))


def test_the_calibrated_law():
    row = cradle_models.model_path("row_3")
    said = refusal(row, law="calibrated", alpha=(1.0, 1.0), sh=1.0)
    assert "does not support law = 'calibrated', of the instance 'impact'" in said


def test_balls_on_strings():
    said = refusal(cradle_models.model_path("two_string_3"))
    assert "does not support the tendon 'string_front_1' on the body" in said


def test_a_model_without_the_plugin():
    model = mujoco.MjModel.from_xml_string(scene())
    with pytest.raises(mujoco_impact.errors.SceneError, match="attach adds one"):
        warp.put_impacts(model)


def test_numbers_that_are_not_valid():
    model = mujoco_impact.attach(scene()).compile()
    with pytest.raises(mujoco_impact.errors.SceneError, match="nworld = 0"):
        warp.put_impacts(model, nworld=0)


def test_a_plugin_whose_settings_have_another_layout_is_refused(monkeypatch):
    class Longer(_Layout):
        _fields_ = (("later", ctypes.c_double),)

    monkeypatch.setattr("mujoco_impact.warp.settings._Layout", Longer)
    model = mujoco_impact.attach(scene()).compile()
    with pytest.raises(mujoco_impact.errors.PluginError, match="not 64 bytes"):
        warp.put_impacts(model)


def test_what_is_supported_is_taken():
    settings = {"restitution": 0.5, "young": 2e10, "friction": "none"}
    model = mujoco_impact.attach(scene(geom='condim="3"'), **settings).compile()
    assert warp.put_impacts(model, nworld=2).nworld == 2
