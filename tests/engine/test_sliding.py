"""What slides, rolls and falls over on a floor whose contacts are all the plugin's."""

import mujoco
import numpy as np
import pytest
from held_balls import Balls, truth

import mujoco_impact

GRAVITY, STEP = 9.81, 0.002

SHAPES = {
    "box": 'type="box" size=".05 .05 .05"',
    "cylinder": 'type="cylinder" size=".05 .05"',
    "capsule": 'type="capsule" size=".05 .05" euler="0 90 0"',
}


@pytest.mark.parametrize(
    ("integrator", "cone"),
    [("Euler", "pyramidal"), ("Euler", "elliptic"), ("RK4", "pyramidal")],
)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("e", [0.0, 0.3, 0.5, 0.8])
def test_what_slides_stops_where_it_should(shape, e, integrator, cone):
    """u^2 / (2 mu g), however it chatters. Without friction in impacts: .5 to 1.3 m.

    MuJoCo's floor answers the sudden slip with nine times the weight in the first step.
    So everything hops, and lands as chance has it: the median of three starts.
    """
    mu = 0.5
    xml = f"""
    <mujoco><option timestep="{STEP}" cone="{cone}" integrator="{integrator}"/>
      <default><geom friction="{mu}"/></default>
      <worldbody><geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .05"><freejoint/><geom {SHAPES[shape]}/></body>
      </worldbody></mujoco>"""
    model = mujoco_impact.attach(xml, restitution=e).compile()
    ratios = []
    for speed in (1.99, 2.0, 2.01):
        data = mujoco.MjData(model)
        # the velocity of the path is half a step ahead of that of Euler's steps
        lag = mu * GRAVITY * STEP / 2 if integrator == "Euler" else 0.0
        data.qvel[0] = speed + lag
        mujoco.mj_step(model, data, 750)
        ratios.append(data.qpos[0] / (speed**2 / (2 * mu * GRAVITY)))
    assert np.median(ratios) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
@pytest.mark.parametrize("e", [0.3, 0.8])
def test_thin_dominoes_all_fall(e, cone, integrator):
    """Ten stones 8 mm thick; the first leans by 12 degrees and is let go."""
    half, gap, lean = np.array([0.004, 0.012, 0.024]), 0.02, np.deg2rad(12)
    size = " ".join(map(str, half))
    # it stands on its front edge
    c, s = np.cos(lean), np.sin(lean)
    at = f"{half[0] - c * half[0] + s * half[2]} 0 {s * half[0] + c * half[2]}"
    stones = [f'<body pos="{at}" euler="0 12 0">']
    stones += [
        f'<body pos="{i * (2 * half[0] + gap)} 0 {half[2]}">' for i in range(1, 10)
    ]
    bodies = "".join(
        f'{stone}<freejoint/><geom type="box" size="{size}" density="600"/></body>'
        for stone in stones
    )
    xml = f"""
    <mujoco><option timestep="{STEP}" cone="{cone}" integrator="{integrator}"/>
      <worldbody><geom type="plane" size="5 5 .1"/>{bodies}</worldbody></mujoco>"""
    model = mujoco_impact.attach(xml, restitution=e).compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 750)
    upright = data.xmat[1:, 8]
    # the last lies flat, each other leans on its neighbour
    assert upright.max() < np.cos(np.deg2rad(60))
    assert upright[-1] < np.cos(np.deg2rad(85))


RADIUS, MASS = 0.0286, 0.17
BALL, CLOTH = 0.05, 0.2  # friction between balls and on the table


def table(x: tuple[float, float], integrator: str, cone: str) -> str:
    """A billiard table with two balls at these places [m]."""
    bodies = "".join(
        f'<body pos="{place} 0 {RADIUS}"><freejoint/>'
        f'<geom size="{RADIUS}" mass="{MASS}"/></body>'
        for place in x
    )
    return f"""
    <mujoco><option timestep="{STEP}" cone="{cone}" integrator="{integrator}"/>
      <default><geom friction="{BALL}"/></default>
      <worldbody><geom type="plane" size="9 9 .1" friction="{CLOTH}"/>{bodies}
      </worldbody></mujoco>"""


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_a_straight_shot_ends_rolling_as_on_mujocos_table(cone, integrator):
    """From what the Hertz problem leaves, MuJoCo alone brings both balls to roll."""
    speed = 2.0
    model = mujoco_impact.attach(table((-0.2, 0), integrator, cone)).compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 250)
    data.qvel[[0, 4]] = speed, speed / RADIUS
    mujoco.mj_step(model, data, 1000)
    # the truth has the one that strikes last
    meeting = Balls(
        np.full(2, RADIUS),
        np.array([[0, 0, RADIUS], [-2 * RADIUS, 0, RADIUS]]),
        np.array([[0, 0, 0], [speed, 0, 0]]),
        rolls=True,
        pair_friction=BALL,
        floor_friction=CLOTH,
        density=MASS / (4 / 3 * np.pi * 7850 * RADIUS**3),
    )
    left = truth(meeting)
    alone = mujoco.MjModel.from_xml_string(table((0, 1), integrator, cone))
    rolling = mujoco.MjData(alone)
    mujoco.mj_step(alone, rolling, 250)
    rolling.qvel[[0, 6]] = left.velocity[[1, 0], 0]
    rolling.qvel[[4, 10]] = left.spin[[1, 0], 1]
    mujoco.mj_step(alone, rolling, 1000)
    after, expected = data.qvel.reshape(2, 6), rolling.qvel.reshape(2, 6)
    assert expected[:, 0].min() > 0.2 * speed
    np.testing.assert_allclose(after[:, 0], expected[:, 0], rtol=0.02)
    # they roll: MuJoCo lets what rolls creep by 3e-3 of its speed
    np.testing.assert_allclose(RADIUS * after[:, 4], after[:, 0], rtol=0.02)
