"""Impacts with what does not move, and what happens deeper than the depth."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, header, with_integrator

import mujoco_impact

RADIUS, HEIGHT, GRAVITY = 0.02, 0.5, 9.81

BALL = f"""
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1" condim="1"/>
    <body pos="0 0 {RADIUS + HEIGHT}">
      <freejoint/>
      <geom name="ball" size="{RADIUS}" mass=".1" condim="1"/>
    </body>
  </worldbody>
</mujoco>
"""


def dropped(integrator="Euler", **options):
    spec = with_integrator(BALL, integrator, 0.002)
    model = mujoco_impact.attach(spec, **options).compile()
    return model, mujoco.MjData(model)


def apex(model, data) -> float:
    """Greatest height of the parabola through the present state [m]."""
    speed = data.qvel[2]
    if model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4:
        # the other integrators step q += h v first with the new v: at the time of q the
        # ball moves with v + a h/2
        speed -= GRAVITY * model.opt.timestep / 2
    return data.qpos[2] - RADIUS + speed**2 / (2 * GRAVITY)


def bounce(model, data, times: int = 1) -> None:
    """Steps until so many impacts are over."""
    while header(model, data).count < times:
        mujoco.mj_step(model, data)
        assert data.time < times
    while header(model, data).active:
        mujoco.mj_step(model, data)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("e", [1.0, 0.8, 0.5])
def test_a_ball_bounces_to_e_squared_of_its_height(e, integrator):
    model, data = dropped(integrator, restitution=e)
    bounce(model, data)
    # gravity acts on during the contact of .08 ms, unseen by the law: 2 g W / u = 5e-4
    assert apex(model, data) / HEIGHT == pytest.approx(e**2, abs=1e-3)


def test_many_elastic_bounces_keep_the_height():
    model, data = dropped("RK4", restitution=1.0)
    bounce(model, data, times=15)
    # each may lose what gravity takes during the contact: u W
    loss = 15 * np.sqrt(2 * GRAVITY * HEIGHT) * header(model, data).pulses[:, 6].max()
    assert loss < 0.01 * HEIGHT
    assert HEIGHT - 1.05 * loss < apex(model, data) < HEIGHT * (1 + 1e-6)


def test_a_ball_without_restitution_stays_on_the_floor():
    """Caught by MuJoCo's own contact at the depth, where it rests."""
    depth = 1e-3
    model, data = dropped(restitution=0.0, depth=depth)
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert header(model, data).count >= 1
    z = data.qpos[2] - RADIUS
    # MuJoCo's contact gives way by a fraction of a millimetre under 1 N
    assert -depth - 5e-4 < z < 0
    assert abs(data.qvel[2]) < 1e-3


def test_deeper_than_the_depth_the_contact_is_mujocos():
    """A ball that starts inside the floor is pushed out, by MuJoCo."""
    model, data = dropped(depth=1e-3)
    data.qpos[2] = RADIUS - 3e-3
    mujoco.mj_forward(model, data)
    (contact,) = data.contact
    assert contact.exclude == 0
    assert data.nefc == 1
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert data.qpos[2] > RADIUS - 2e-3


def test_above_the_depth_it_is_ours():
    model, data = dropped(depth=1e-3)
    data.qpos[2] = RADIUS - 0.5e-3
    mujoco.mj_forward(model, data)
    (contact,) = data.contact
    assert contact.exclude == 1
    assert data.nefc == 0
    data.qvel[2] = -0.1
    mujoco.mj_step(model, data)
    assert header(model, data).count == 1
    assert data.qvel[2] > 0


def test_depth_and_gap_add_up_over_two_owned_geoms():
    two = BALL.replace('type="plane"', 'type="plane" pos="0 0 -9"')
    two = two.replace(
        "</worldbody>",
        f'<body pos="{2 * RADIUS + 5e-3} 0 {RADIUS + HEIGHT}"><freejoint/>'
        f'<geom name="other" size="{RADIUS}"/></body></worldbody>',
    )
    model = mujoco_impact.attach(two, gap=4e-3, depth=1e-3).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    (contact,) = data.contact
    assert contact.includemargin == pytest.approx(-2e-3)
    assert contact.dist == pytest.approx(5e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_an_oblique_bounce_keeps_the_speed_along_the_floor(angle):
    """Impulses act along the normal only."""
    model, data = dropped(restitution=0.7)
    data.qvel[:2] = np.cos(angle), np.sin(angle)
    bounce(model, data)
    assert data.qvel[2] > 0
    expected = [np.cos(angle), np.sin(angle)]
    np.testing.assert_allclose(data.qvel[:2], expected, rtol=0, atol=1e-14)


BOX = """
<mujoco>
  <option timestep="0.002" integrator="{integrator}"/>
  <worldbody>
    <geom type="plane" size="1 1 .1" friction=".5"/>
    <body pos="0 0 {height}" euler="{tilt}">
      <freejoint/>
      <geom type="box" size=".05 .05 .05" friction=".5"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
@pytest.mark.parametrize("tilt", ["0 0 0", "45 0 0", "45 35.264 0"])
def test_a_box_lands_on_the_floor_from_every_height(tilt, integrator):
    """Also where the fall within a step closes what speed alone would not.

    Of the heights, some have an impact that comes so late in a step.
    """
    deepest = 0.0
    for height in np.linspace(0.15, 0.5, 15):
        xml = BOX.format(integrator=integrator, height=height, tilt=tilt)
        model = mujoco_impact.attach(xml, restitution=0.3).compile()
        data = mujoco.MjData(model)
        for _ in range(500):
            mujoco.mj_step(model, data)
            deepest = min(deepest, data.contact.dist.min(initial=0.0))
    # MuJoCo's soft contact, of a time constant of 20 ms, stops a body of u_rest = 2 g h
    # over u_rest / 50 e = .29 mm; it then carries it 18 um deep
    assert -0.31e-3 < deepest < -5e-6
