"""Coulomb friction of impacts in scenes, against closed forms."""

import mujoco
import numpy as np
import pytest

import mujoco_impact

RADIUS, MASS = 0.03, 0.17
INTEGRATORS = ("Euler", "implicitfast", "RK4", "discrete")


def sphere_after(
    velocity: np.ndarray, spin: np.ndarray, mu: float, e: float
) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and spin of a solid ball after an impact on the plane z = 0, both world.

    Rigid Coulomb friction: a slip v of the lowest point needs the impulse -2/7 m v to
    stop, and gets it if that is within mu (1 + e) m u. Held against the rows of
    sphere_plane.csv (R .03 m, m .17 kg, any slip and spin), which agree to 1e-12.
    """
    down = np.array([0, 0, -RADIUS])
    slip = velocity + np.cross(spin, down)
    slip[2] = 0.0
    normal = (1 + e) * MASS * -velocity[2]
    needed = 2 / 7 * MASS * np.linalg.norm(slip)
    friction = -2 / 7 * MASS * slip
    if needed > mu * normal:
        friction *= mu * normal / needed
    after = velocity + np.array([0, 0, normal]) / MASS + friction / MASS
    turn = np.cross(down, friction) / (0.4 * MASS * RADIUS**2)
    return after, spin + turn


def world_spin(data: mujoco.MjData) -> np.ndarray:
    """Of the first free body [rad/s]."""
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, data.qpos[3:7])
    return matrix.reshape(3, 3) @ data.qvel[3:6]


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize(
    ("velocity", "spin"),
    [
        ([2.0, 0, -1], [0, 0, 0]),  # slides throughout, or sticks with high friction
        ([0.3, 0, -1], [0, 0, 0]),
        ([0, 0, -3], [5, 50, -80]),  # spin about the normal is left alone
        ([-0.4, 0.7, -2], [-70, 30, 15]),
    ],
)
@pytest.mark.parametrize(("mu", "e"), [(0.05, 1.0), (0.3, 0.8), (1.0, 0.5)])
def test_a_ball_leaves_a_plane_as_the_closed_form_says(
    integrator, velocity, spin, mu, e
):
    xml = f"""
    <mujoco>
      <option integrator="{integrator}" timestep=".002" gravity="0 0 0"/>
      <default><geom friction="{mu}"/></default>
      <worldbody>
        <geom type="plane" size="5 5 .1"/>
        <body pos="0 0 {RADIUS + 0.0031}"><freejoint/>
          <geom size="{RADIUS}" mass="{MASS}"/></body>
      </worldbody>
    </mujoco>"""
    model = mujoco_impact.attach(xml, restitution=e).compile()
    data = mujoco.MjData(model)
    data.qvel[:] = [*velocity, *spin]
    mujoco.mj_step(model, data, 10)
    speed = np.linalg.norm(velocity)
    after, turn = sphere_after(np.array(velocity), np.array(spin, float), mu, e)
    # rounding of the law; the bound of the acceptance is 1e-5
    assert np.abs(data.qvel[:3] - after).max() < 1e-7 * speed
    assert RADIUS * np.abs(world_spin(data) - turn).max() < 1e-7 * speed


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("young", [2e11, 1e9])
def test_gravity_makes_no_slip_of_a_ball_that_sticks(integrator, young):
    """The impulse that carries its weight meanwhile comes without friction.

    Scaled along, friction left a slip of 4e-4 m/s, and 2e-3 with the softer ball.
    """
    xml = f"""
    <mujoco>
      <option integrator="{integrator}" timestep=".002"/>
      <worldbody>
        <geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .3"><freejoint/><geom size="{RADIUS}" mass="{MASS}"/></body>
      </worldbody>
    </mujoco>"""
    model = mujoco_impact.attach(xml, restitution=0.8, young=young).compile()
    data = mujoco.MjData(model)
    data.qvel[:] = [1, 0, 0, 0, -100, 0]
    while data.qvel[2] <= 0:
        mujoco.mj_step(model, data)
    slip = data.qvel[0] - RADIUS * world_spin(data)[1]
    assert abs(slip) < 1e-7


@pytest.mark.parametrize("cut", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("sidespin", [-1.0, 0.0, 0.5])
def test_a_ball_throws_another_as_the_closed_form_says(cut, sidespin):
    """Two equal balls: 1/7 of the slip is what stops it, mu of the impulse the most."""
    mu, speed = 0.06, 1.5
    angle = np.deg2rad(cut)
    normal = np.array([np.cos(angle), np.sin(angle), 0])
    across = np.array([-np.sin(angle), np.cos(angle), 0])
    xml = f"""
    <mujoco>
      <option timestep=".002" gravity="0 0 0"/>
      <default><geom size="{RADIUS}" mass="{MASS}" friction="{mu}"/></default>
      <worldbody>
        <body><freejoint/><geom/></body><body><freejoint/><geom/></body>
      </worldbody>
    </mujoco>"""
    model = mujoco_impact.attach(xml).compile()
    data = mujoco.MjData(model)
    data.qpos[:3] = -2 * RADIUS * normal - [0.0031 * speed, 0, 0]
    data.qvel[0], data.qvel[5] = speed, sidespin * speed / RADIUS
    mujoco.mj_step(model, data, 10)
    impulse = MASS * speed * np.cos(angle)
    # the contact of the cue moves along `across` by its speed and its spin
    slip = speed * (-np.sin(angle) + sidespin)
    friction = np.clip(MASS * slip / 7, -mu * impulse, mu * impulse)
    expected = (impulse * normal + friction * across) / MASS
    assert np.abs(data.qvel[6:9] - expected).max() < 1e-7 * speed


def test_a_ball_that_slides_comes_to_roll():
    """At 5/7 of its speed, and does not bounce on the way."""
    xml = """
    <mujoco><option timestep=".002"/><default><geom friction=".3"/></default>
      <worldbody><geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .05"><freejoint/><geom size=".05"/></body>
      </worldbody></mujoco>"""
    trajectory = mujoco_impact.run(
        mujoco_impact.attach(xml), duration=1.0, qvel=[1, 0, 0, 0, 0, 0]
    )
    # what rolls in MuJoCo creeps by 3e-3 of its speed
    assert trajectory.qvel[-1, 0] == pytest.approx(5 / 7, abs=1.5e-3)
    assert not [impact for impact in trajectory.impacts if impact.time > 0.1]


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
def test_balls_on_a_table_meet_as_without_it(integrator):
    """Nothing makes them hop, and MuJoCo's own contact of the two adds nothing."""
    xml = f"""
    <mujoco><option timestep=".002" integrator="{integrator}"/>
      <default><geom size=".028" mass=".17" condim="1"/></default>
      <worldbody><geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .028"><freejoint/><geom/></body>
        <body pos="-.2 .02 .028"><freejoint/><geom/></body>
      </worldbody></mujoco>"""
    model = mujoco_impact.attach(xml).compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 500)
    data.qvel[6] = 2.0
    mujoco.mj_step(model, data, 60)
    normal = np.array([np.sqrt(1 - (0.02 / 0.056) ** 2), -0.02 / 0.056])
    thrown = 2 * normal[0] * normal
    # the place where they meet is known to rounding of the floor's softness
    assert np.abs(data.qvel[:2] - thrown).max() < 1e-6
    assert np.abs(data.qvel[6:8] - ([2, 0] - thrown)).max() < 1e-6
    assert np.abs(data.qvel[[2, 8]]).max() < 1e-6


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_an_arm_that_friction_would_wedge_bounces_without(integrator):
    """The tip of a hinge moves along a line, and friction that holds it never ends."""
    xml = f"""
    <mujoco><option timestep=".002" integrator="{integrator}" gravity="0 0 0"/>
      <worldbody><geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .2"><joint type="hinge" axis="0 1 0"/>
          <geom type="capsule" fromto="0 0 0 .25 0 0" size=".02"/></body>
      </worldbody></mujoco>"""
    model = mujoco_impact.attach(xml, restitution=0.5).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 3.0
    mujoco.mj_step(model, data, 500)
    assert data.qvel[0] == pytest.approx(-1.5, rel=1e-3)


@pytest.mark.parametrize("e", [0.5, 1.0])
def test_what_ties_leave_to_an_arm_decides_whether_friction_would_wedge_it(e):
    """Two of three hinges are held by equality constraints. It was .3 of the speed."""
    link = '<geom type="capsule" fromto="0 0 0 .1 0 0" size=".02"/>'
    held = 'solref=".004 1" solimp=".9999 .9999 .001"'
    xml = f"""
    <mujoco><option timestep=".002" gravity="0 0 0"/>
      <worldbody><geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .2"><joint axis="0 1 0"/>{link}
          <body pos=".1 0 0"><joint name="a" axis="0 1 0"/>{link}
            <body pos=".1 0 0"><joint name="b" axis="0 1 0"/>{link}</body></body></body>
      </worldbody>
      <equality><joint joint1="a" {held}/><joint joint1="b" {held}/></equality>
    </mujoco>"""
    model = mujoco_impact.attach(xml, restitution=e).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 3.0
    mujoco.mj_step(model, data, 150)
    # what holds the hinges is a little soft
    assert data.qvel[0] == pytest.approx(-3 * e, rel=5e-3)


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_a_belt_throws_a_ball_as_a_floor_that_moves(integrator):
    """Of `surfacevel` and the velocity of a ball only the difference counts."""

    def velocity_after(belt: float, ball: float) -> np.ndarray:
        xml = f"""
        <mujoco><option timestep=".002" integrator="{integrator}" gravity="0 0 0"/>
          <default><geom friction=".3"/></default>
          <worldbody>
            <geom type="plane" size="50 50 .1" surfacevel="{belt} .5 0 0 0 0"/>
            <body pos="0 0 .053"><freejoint/><geom size=".05" mass=".2"/></body>
          </worldbody></mujoco>"""
        model = mujoco_impact.attach(xml, restitution=0.8).compile()
        data = mujoco.MjData(model)
        data.qvel[:] = [ball, 0, -2, 1, -3, 2]
        mujoco.mj_step(model, data, 10)
        return data.qvel - [ball, 0, 0, 0, 0, 0]

    thrown = velocity_after(1.0, 0.0)
    assert thrown[0] > 0.2
    # rounding
    np.testing.assert_allclose(thrown, velocity_after(0.0, -1.0), rtol=0, atol=1e-12)


def test_stones_that_lean_on_each_other_only_fall():
    """Dominoes on hinges. A push that was rounding threw them at 1e4 rad/s."""
    stones = "".join(
        f'<body pos="{0.036 * i} 0 0"><joint axis="0 1 0" range="-1 90"/>'
        '<geom type="box" size=".004 .012 .024" pos="-.004 0 .024" mass=".01"/></body>'
        for i in range(12)
    )
    xml = f"<mujoco><worldbody>{stones}</worldbody></mujoco>"
    model = mujoco_impact.attach(xml, restitution=0.0).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 4.0
    fastest = 0.0
    for _ in range(1000):
        mujoco.mj_step(model, data)
        fastest = max(fastest, np.abs(data.qvel).max())
    assert 4.0 <= fastest < 30.0  # they fall from standing
    assert np.abs(data.qvel[:6]).max() < 0.1


@pytest.mark.parametrize("e", [0.3, 1.0])
@pytest.mark.parametrize("mu", [0.3, 2.0])
def test_a_ball_in_a_groove_gains_no_energy(mu, e):
    """Friction of 2 wedges it between the walls, where it stays."""
    xml = f"""
    <mujoco><option timestep=".002"/><default><geom friction="{mu}"/></default>
      <worldbody><geom type="plane" size="5 5 .1" euler="0 45 0"/>
        <geom type="plane" size="5 5 .1" euler="0 -45 0"/>
        <body pos="0 0 .3"><freejoint/><geom size=".05"/></body>
      </worldbody></mujoco>"""
    model = mujoco_impact.attach(xml, restitution=e).compile()
    data = mujoco.MjData(model)
    highest = 0.0
    for _ in range(1000):
        mujoco.mj_step(model, data)
        spin = data.qvel[3:] @ data.qvel[3:] * 0.4 * 0.05**2
        moving = 0.5 * (data.qvel[:3] @ data.qvel[:3] + spin)
        highest = max(highest, 9.81 * data.qpos[2] + moving)
    assert highest < 1.001 * 9.81 * 0.3


def test_a_light_tip_that_friction_all_but_wedges_gains_no_energy():
    """Its overlap after the impact is what friction leaves, too.

    Without that its pulse was moved to 8 ms before the step, and the tip left with
    380 rad/s instead of 14.
    """
    xml = """
    <mujoco><option timestep=".0005" integrator="RK4"/>
      <default><geom friction="5 .005 .0001"/></default>
      <worldbody><geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .15"><joint type="slide" axis="0 0 1"/>
          <joint type="slide" axis="0 1 0"/><geom size=".02" mass="1"/>
          <body pos="0 0 -.05"><joint axis="1 0 0" stiffness="1"/>
            <geom type="capsule" fromto="0 0 0 0 0 -.03" size=".01"/></body>
        </body>
      </worldbody></mujoco>"""
    model = mujoco_impact.attach(xml, restitution=0.5).compile()
    data = mujoco.MjData(model)
    data.qpos[:] = [-0.060301135316819986, 0.009573731293295688, -0.14375372211852505]
    data.qvel[:] = [0.06219289660486134, 0.09462194186593806, 26.125220778747753]
    mujoco.mj_step(model, data)
    assert 5 < data.qvel[2] < 20
