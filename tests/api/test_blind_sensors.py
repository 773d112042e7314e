"""Sensors of MuJoCo's that do not see our impacts are named when they are attached."""

from __future__ import annotations

import warnings

import mujoco
import numpy as np
import pytest

from mujoco_impact import attach
from mujoco_impact.errors import ImpactWarning
from mujoco_impact.sensor import read_sensor, sensor_slice

PLATE = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="plate"><joint type="slide" axis="1 0 0"/>
      <geom name="plate" type="box" size=".01 .1 .1" mass="1"/>
      <site name="skin" type="box" size=".02 .11 .11"/>
      <body name="tip" pos=".1 0 0"><site name="tip"/>
        <geom name="tip" size=".01" mass=".1" contype="2" conaffinity="2"/></body>
    </body>
    <body name="ball" pos="-.06 0 0"><joint name="x" type="slide" axis="1 0 0"/>
      <geom name="ball" size=".02" mass=".1"/><site name="ball"/></body>
  </worldbody>
  <sensor>{sensors}</sensor>
</mujoco>
"""

MISLED = {
    "touch": '<touch name="s" site="skin"/>',
    "force": '<force name="s" site="skin"/>',
    "torque": '<torque name="s" site="ball"/>',
    "contact": '<contact name="s" geom1="ball"/>',
}


@pytest.mark.parametrize("geoms", [None, ["ball"], ["plate"]])
@pytest.mark.parametrize("kind", MISLED)
def test_a_sensor_that_does_not_see_our_impacts_is_named(
    kind: str, geoms: list[str] | None
) -> None:
    """Whichever of the two geoms is owned: the contact is ours."""
    with pytest.warns(ImpactWarning, match=rf"'s' \({kind}\) reads 0") as caught:
        attach(PLATE.format(sensors=MISLED[kind]), geoms=geoms)
    assert len(caught) == 1
    cure = "from mujoco_impact.sensor import read_sensor, sensor_slice; "
    assert cure + "read_sensor(data.sensordata[" in str(caught[0].message)


@pytest.mark.parametrize(
    "sensor",
    [
        '<touch site="tip"/>',
        '<force site="tip"/>',
        '<accelerometer site="skin"/>',
        '<contact geom1="tip"/>',
        '<contact subtree1="tip"/>',
        '<framelinacc objtype="site" objname="skin"/>',
        '<jointvel joint="x"/>',
    ],
)
def test_a_sensor_that_reads_right_is_not_named(sensor: str) -> None:
    """Of bodies that nothing strikes, or that reads motion."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        attach(PLATE.format(sensors=sensor), geoms=["ball", "plate"])


def test_what_the_warning_says_is_true() -> None:
    """The sensors named read 0 or a spike, ours the impulse, the others the motion."""
    sensors = (
        '<touch name="touch" site="skin"/><force name="force" site="skin"/>'
        '<force name="tip" site="tip"/><accelerometer name="acc" site="skin"/>'
        '<contact name="contact" geom1="ball" data="force" reduce="netforce"/>'
    )
    with pytest.warns(ImpactWarning, match=r"'contact' \(contact\) read 0") as caught:
        model = attach(PLATE.format(sensors=sensors)).compile()
    data = mujoco.MjData(model)
    data.joint("x").qvel[0] = 1.0
    sums = dict.fromkeys(("touch", "force", "tip", "acc", "contact"), 0.0)
    for _ in range(60):
        mujoco.mj_step(model, data)
        for name in sums:
            largest = data.sensor(name).data[0] * model.opt.timestep
            sums[name] += float(largest)
    # a ball of 0.1 kg at 1 m/s on 1.1 kg at rest: 2 m M / (m + M) v
    impulse = 2 * 0.1 * 1.1 / 1.2
    assert sums["touch"] == sums["contact"] == 0.0
    # nothing holds the plate in the direction of its joint
    assert sums["force"] == pytest.approx(impulse, rel=1e-5)
    assert sums["acc"] == pytest.approx(impulse / 1.1, rel=1e-5)
    assert sums["tip"] == pytest.approx(0.1 * impulse / 1.1, rel=1e-5)
    reading = read_sensor(data.sensordata[sensor_slice(model)])
    # the cure works as it is printed
    printed = str(caught[0].message).partition("own sensor: ")[2]
    imports, _, expression = printed.partition("; ")
    names = {"data": data, "model": model}
    exec(imports, names)
    again = eval(expression, names)
    np.testing.assert_array_equal(again.total, reading.total)
    np.testing.assert_allclose(reading.impulse[[0, -1]], impulse, rtol=1e-5)


@pytest.mark.parametrize(
    ("shape", "named"), [('type="box" size=".02 .03 .04"', True), ('size=".02"', False)]
)
def test_the_accelerometer_of_a_tumbling_body_is_named(shape: str, named: bool) -> None:
    """Its velocity is set when the step ends; that of a ball is changed by a force."""
    scene = f"""<mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body name="it" pos="0 0 .3"><freejoint/><geom name="it" {shape}/>
        <site name="it"/></body></worldbody>
      <sensor><accelerometer name="s" site="it"/></sensor></mujoco>"""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        attach(scene)
    told = [str(one.message) for one in caught if "accelerometer" in str(one.message)]
    assert bool(told) == named
