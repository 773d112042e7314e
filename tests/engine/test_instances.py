"""Several instances of the plugin in one scene."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact
from mujoco_impact.errors import ConfigError

TWO_BALLS = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0" integrator="{integrator}"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
  <worldbody>
    <body><joint/><geom name="a"/></body>
    <body pos=".0205 0 0"><joint/><geom name="b"/></body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("duration", ["hertz", 5e-3])
def test_a_contact_between_geoms_of_two_instances_is_resolved_once(
    integrator, duration
):
    scene = TWO_BALLS.format(integrator=integrator)
    options = {"duration": duration, "depth": 0.004}
    scene = mujoco_impact.attach(scene, geoms=["a"], name="one", **options)
    scene = mujoco_impact.attach(scene, geoms=["b"], name="two", **options)
    motion = mujoco_impact.run(scene, duration=0.02, qvel=[1.0, 0.0])
    assert len(motion.impacts) == 1
    # equal masses exchange velocities; 1e-12 is rounding
    np.testing.assert_allclose(motion.qvel[-1], [0, 1], atol=1e-12)


def test_the_first_instance_is_the_one_that_reports_it():
    scene = mujoco_impact.attach(
        TWO_BALLS.format(integrator="Euler"), geoms=["a"], name="one"
    )
    model = mujoco_impact.attach(scene, geoms=["b"], name="two").compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    for _ in range(3):
        mujoco.mj_step(model, data)
    first, second = data.sensor("one").data, data.sensor("two").data
    assert first[6] == 1
    assert not second.any()


def attached(order, settings, xml=TWO_BALLS):
    """The balls, each to an instance of its own, attached in an order."""
    scene = xml.format(integrator="Euler")
    for ball in order:
        options = {"restitution": 0.5, "depth": 1e-5} | settings.get(ball, {})
        scene = mujoco_impact.attach(scene, geoms=[ball], name=f"of_{ball}", **options)
    return scene.compile()


def test_it_does_not_matter_which_was_attached_first():
    """With the same settings, which is all that is allowed."""
    ends = []
    for order in ("ab", "ba"):
        model = attached(order, {})
        data = mujoco.MjData(model)
        data.qvel[0] = 1.0
        mujoco.mj_step(model, data, 20)
        ends.append((data.qpos.copy(), data.qvel.copy()))
    assert ends[0][1][1] == pytest.approx(0.75, rel=1e-12)
    for one, other in zip(*ends, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("order", ["ab", "ba"])
@pytest.mark.parametrize(
    "settings",
    [
        {"restitution": 0.8},
        {"young": 1e9},
        {"duration": 5e-3},
        {"dissipation": "viscous"},
        {"friction": "paper", "mu_s": 0.1, "mu_d": 0.1},
    ],
)
def test_instances_of_other_settings_may_not_meet(order, settings):
    """A contact between them would take those of the one attached first."""
    with pytest.raises(ConfigError, match="different settings") as caught:
        attached(order, {"b": settings})
    for name in ("'of_a'", "'of_b'", "'a'", "'b'"):
        assert name in str(caught.value)


def test_a_number_written_in_another_way_is_the_same_setting():
    assert attached("ab", {"b": {"young": 200e9}, "a": {"young": 2e11}}).nplugin == 2
    assert attached("ab", {"b": {"duration": "hertz"}}).nplugin == 2


APART = TWO_BALLS.replace('name="b"', 'name="b" contype="2" conaffinity="2"')
EXCLUDED = (
    TWO_BALLS.replace("<body>", '<body name="A">')
    .replace("<body pos", '<body name="B" pos')
    .replace("</mujoco>", '<contact><exclude body1="B" body2="A"/></contact></mujoco>')
)


@pytest.mark.parametrize("xml", [APART, EXCLUDED])
def test_instances_that_cannot_meet_may_have_any_settings(xml):
    assert attached("ab", {"b": {"restitution": 0.8}}, xml).nplugin == 2


def test_an_explicit_pair_meets_whatever_its_bits_say():
    pair = APART.replace(
        "</mujoco>", '<contact><pair geom1="a" geom2="b"/></contact></mujoco>'
    )
    with pytest.raises(ConfigError, match="different settings"):
        attached("ab", {"b": {"restitution": 0.8}}, pair)


def test_a_scene_written_by_hand_is_refused_as_well():
    spec = mujoco.MjSpec.from_string(attached_xml())
    with pytest.raises(ValueError, match="different settings"):
        spec.compile()


def attached_xml() -> str:
    """Two instances of the same settings, one of which is then changed in the text."""
    scene = TWO_BALLS.format(integrator="Euler")
    scene = mujoco_impact.attach(scene, geoms=["a"], name="one", restitution=0.5)
    scene = mujoco_impact.attach(scene, geoms=["b"], name="two", restitution=0.5)
    scene.compile()
    return scene.to_xml().replace('value="0.5"', 'value="0.6"', 1)
