"""Bodies at rest are MuJoCo's: the plugin changes nothing about how they lie."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, with_integrator

import mujoco_impact

RADIUS = 0.02


def table(count: int) -> str:
    """Balls laid on a table, out of reach of each other."""
    balls = "".join(
        f'<body pos="{0.1 * i} 0 {RADIUS}"><freejoint/>'
        f'<geom name="ball{i}" size="{RADIUS}" mass=".1"/></body>'
        for i in range(count)
    )
    return f"""
    <mujoco>
      <worldbody><geom type="plane" size="9 9 1"/>{balls}</worldbody>
    </mujoco>"""


def boxes(places: list[tuple[float, float]]) -> str:
    """Boxes of half a width of 5 cm above a floor, centres at these x and z [m]."""
    bodies = "".join(
        f'<body pos="{x} 0 {z}"><freejoint/>'
        '<geom type="box" size=".05 .05 .05"/></body>'
        for x, z in places
    )
    return f"""
    <mujoco>
      <worldbody><geom type="plane" size="5 5 .1"/>{bodies}</worldbody>
    </mujoco>"""


def sinks(model: mujoco.MjModel) -> np.ndarray:
    """How deep each ball lies in the table after a second [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 500)
    assert np.abs(data.qvel).max() < 1e-6
    return RADIUS - data.qpos.reshape(-1, 7)[:, 2]


@pytest.mark.parametrize("count", [1, 16, 50])
def test_balls_on_a_table_sink_as_deep_as_without_the_plugin(count):
    alone = sinks(mujoco.MjModel.from_xml_string(table(count)))
    ours = sinks(
        mujoco_impact.attach(table(count), restitution=0.5, friction="none").compile()
    )
    # the default depth is .1 um
    np.testing.assert_allclose(ours, alone, rtol=0, atol=2e-7)


@pytest.mark.parametrize("integrator", [name for name in INTEGRATORS if name != "RK4"])
def test_a_ball_that_bounced_comes_to_rest_there_too(integrator):
    spec = with_integrator(table(1), integrator, 0.002)
    alone = sinks(spec.copy().compile())
    model = mujoco_impact.attach(spec, restitution=0.5, friction="none").compile()
    data = mujoco.MjData(model)
    data.qpos[2] += 0.1
    mujoco.mj_step(model, data, 1500)
    assert data.sensor("impact").data[6] >= 4
    assert np.abs(data.qvel).max() < 1e-6
    np.testing.assert_allclose(RADIUS - data.qpos[2], alone, rtol=0, atol=2e-7)


def test_a_ball_rests_also_where_a_step_is_shorter_than_a_pulse():
    """A pulse that is over leaves the contact to MuJoCo; else the ball falls."""
    spec = with_integrator(table(1), "Euler", 1e-4)
    model = mujoco_impact.attach(spec, friction="none").compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 10_000)
    # alone it sinks by .37 mm: with MuJoCo's default softness, whatever the timestep
    assert RADIUS - data.qpos[2] < 5e-4


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
def test_the_table_does_not_feel_what_strikes_the_ball_on_it(integrator):
    """Nor answers it with friction: Coulomb allows 2 cm/s in a step of 2 ms.

    The cue slides without spin, so that after the impact it stands and its friction is
    nothing; what it loses before is excluded by the sum.
    """
    spec = with_integrator(table(2), integrator, 2e-3)
    model = mujoco_impact.attach(spec, restitution=1.0, friction="none").compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 500)
    data.qvel[0] = 1.0
    before = 0.0
    for _ in range(60):
        before = data.qvel[0]
        mujoco.mj_step(model, data)
        if data.qvel[6] > 0.1:
            break
    g_h = 9.81 * model.opt.timestep
    # it was .80 of the speed
    assert data.qvel[6] > before - 3 * g_h
    # and .2 m/s upwards
    assert np.abs(data.qvel[[2, 8]]).max() < 4 * g_h


def test_a_repeated_forward_changes_nothing_where_boxes_pile_up():
    """A pulse that presses keeps its slot, also when new ones want it."""
    xml = boxes([(0.01 * (i % 2), 0.06 + 0.11 * i) for i in range(5)])
    model = mujoco_impact.attach(xml, restitution=0.7, friction="none").compile()
    data, again = mujoco.MjData(model), mujoco.MjData(model)
    for _ in range(400):
        mujoco.mj_forward(model, again)
        mujoco.mj_step(model, again)
        mujoco.mj_step(model, data)
        np.testing.assert_array_equal(again.qvel, data.qvel)


@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_stacked_boxes_lie_as_without_the_plugin(integrator, restitution):
    xml = boxes([(0, 0.05 + 0.1 * i) for i in range(3)])
    spec = with_integrator(xml, integrator, 2e-3)
    heights = []
    for model in (
        mujoco_impact.attach(spec, restitution=restitution, friction="none").compile(),
        spec.compile(),
    ):
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, 1000)
        assert np.abs(data.qvel).max() < 1e-6
        heights.append(data.xpos[1:, 2])
    # .1 um for each owned geom of the three contacts below
    np.testing.assert_allclose(*heights, rtol=0, atol=1e-6)


LEG = """
<mujoco>
  <option timestep=".002"/>
  <worldbody><geom type="plane" size="5 5 .1"/>
    <body pos="0 0 .5"><joint type="slide" axis="0 0 1"/>
      <geom type="box" size=".1 .1 .1" mass="10" contype="0" conaffinity="0"/>
      <body pos="0 0 -.3">
        <joint type="slide" axis="0 0 1" limited="true" range="-.1 0"/>
        <geom size=".05" mass=".1"/>
      </body>
    </body>
  </worldbody>
</mujoco>"""


def landing(model: mujoco.MjModel) -> tuple[float, float, float]:
    """How deep the foot gets at 2 m/s; how deep it is 3 s later [m], how fast."""
    data = mujoco.MjData(model)
    data.qvel[0] = -2.0
    lowest = 0.0
    for _ in range(1500):
        mujoco.mj_step(model, data)
        lowest = max(lowest, 0.05 - data.geom_xpos[2, 2])
    return lowest, 0.05 - float(data.geom_xpos[2, 2]), float(np.abs(data.qvel).max())


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_trunk_on_a_leg_at_its_stop_does_not_press_it_through_the_floor(
    restitution, integrator
):
    """Nor is it struck again and again while the soft stop gives way."""
    spec = with_integrator(LEG, integrator, 0.002)
    deepest, end, _ = landing(spec.copy().compile())
    ours_deepest, ours_end, speed = landing(
        mujoco_impact.attach(spec, restitution=restitution).compile()
    )
    assert deepest > 0.02, "the stop and the floor are soft"
    # while an elastic foot bounces nothing holds the trunk: half more, not metres
    assert ours_deepest < 1.7 * deepest
    if restitution < 1:
        # .1 um, the default depth
        assert ours_end == pytest.approx(end, abs=2e-7)
        assert speed < 1e-3
