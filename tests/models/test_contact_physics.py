"""What happens in the scenes of contact, against closed forms and integrated contacts.

Timestep 2 ms unless said. The truths use nothing of the plugin: rigid Coulomb friction
with energetic restitution, in closed form or by the pieces of Keller.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

import cradle_models as cm
import mujoco_impact
from mujoco_impact.reference.spheres import Plane, Sphere, sphere_velocities

sys.path.insert(0, str(Path(__file__).parents[1] / "law"))
import keller

G = 9.81


def released(xml: str, **settings) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco_impact.attach(xml, **settings).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("release").id)
    return model, data


def velocities(data: mujoco.MjData) -> np.ndarray:
    """Linear [m/s] and angular [rad/s] velocity of every free body, (n, 2, 3)."""
    return data.qvel.reshape(-1, 2, 3).copy()


def step_past(model: mujoco.MjModel, data: mujoco.MjData, time: float) -> None:
    while data.time < time:
        mujoco.mj_step(model, data)


# ------------------------------------------------------------ bouncing with spin


@pytest.mark.parametrize("friction", [0.1, 0.3])
@pytest.mark.parametrize("restitution", [1.0, 0.8])
def test_spin_after_a_bounce_is_that_of_the_closed_form(friction, restitution):
    spins = (-100.0, 0.0, 100.0)
    xml = cm.spinning_balls(spins, friction=friction)
    model, data = released(xml, restitution=restitution)
    fall = math.sqrt(2 * 0.4 / G)
    # 4 ms after: nothing but gravity has acted since
    step_past(model, data, fall + 0.004)
    radius, mass = cm.RUBBER.radius, cm.RUBBER.mass
    normal = (1 + restitution) * mass * G * fall
    slides = 0
    for spin, (speed, turning) in zip(spins, velocities(data), strict=True):
        # slip v - r omega; it takes 2/7 m of its impulse to stop it
        needed = -2 / 7 * mass * (1.0 - radius * spin)
        tangential = max(-friction * normal, min(friction * normal, needed))
        slides += tangential != needed
        after = 1.0 + tangential / mass
        spun = spin - 2.5 * tangential / (mass * radius)
        # gravity goes on for the 60 µs of the contact: impulses are scaled by 1.2e-4
        assert speed[0] == pytest.approx(after, abs=2e-4)
        assert radius * turning[1] == pytest.approx(radius * spun, abs=4e-4)
    # both regimes are there
    assert slides == (1 if friction == 0.1 else 0)


# -------------------------------------------------------------------- billiards


@pytest.mark.parametrize("side", [-60.0, 0.0, 60.0])
@pytest.mark.parametrize("angle", [20.0, 45.0, 65.0])
def test_the_angle_off_a_cushion_is_that_of_a_sphere_on_a_plane(angle, side):
    """Against a cushion at the height of the centre, and nothing presses on the bed."""
    e, mu, v, radius = 0.8, 0.14, 2.0, cm.POOL.radius
    xml = cm.billiards(0, nose=0.0, cushion=mu, gravity=0.0)
    model, data = released(xml, restitution=e)
    along, into = v * math.sin(math.radians(angle)), v * math.cos(math.radians(angle))
    data.qpos[:2] = -0.5, 1.27 / 2 - radius - 0.05
    data.qvel[:] = along, into, 0.0, 0.0, 0.0, side
    step_past(model, data, 0.05 / into + 0.004)
    velocity, spin = velocities(data)[0]
    # cushion at +y: slip v_x - r omega_z; spin about z alone
    most = mu * (1 + e) * into
    change = max(-most, min(most, -2 / 7 * (along - radius * side)))
    expected = along + change, -e * into
    found = math.degrees(math.atan2(velocity[0], -velocity[1]))
    # a closed form in both: what is left is the path of the ball within a step
    assert found == pytest.approx(
        math.degrees(math.atan2(expected[0], -expected[1])), abs=1e-3
    )
    spun = radius * side - 2.5 * change
    assert radius * spin[2] == pytest.approx(spun, abs=1e-6 * v)


@pytest.mark.parametrize("cut", [15.0, 30.0, 60.0])
@pytest.mark.parametrize("side", [0.0, 40.0])
def test_an_object_ball_is_thrown_by_the_angle_of_the_closed_form(cut, side):
    e, mu, v, radius = 0.95, 0.06, 1.5, cm.POOL.radius
    model, data = released(cm.billiards(1, friction=mu, gravity=0.0), restitution=e)
    phi, way = math.radians(cut), 0.02
    line = np.array([math.cos(phi), math.sin(phi)])
    # it comes along +x and touches with the line of centres at the cut angle
    data.qpos[:2] = data.qpos[7:9] - 2 * radius * line - (way, 0.0)
    data.qvel[:6] = v, 0.0, 0.0, 0.0, 0.0, side
    step_past(model, data, way / v + 0.003)
    velocity = velocities(data)[1, 0]
    # two spheres: W_n = 2/m, W_t = 7/m; slip of the cue ball along the tangent
    slip = v * math.sin(phi) - radius * side
    ratio = min(mu, 2 * abs(slip) / (7 * (1 + e) * v * math.cos(phi)))
    # along the tangent (sin phi, -cos phi) where the slip is positive
    thrown = -math.copysign(math.atan(ratio), slip)
    found = math.degrees(math.atan2(velocity[1], velocity[0])) - cut
    # a closed form in both
    assert found == pytest.approx(math.degrees(thrown), abs=1e-3)


def test_a_break_in_the_middle_is_its_own_mirror_image_and_keeps_momentum():
    speed = 6.0
    model, data = released(cm.billiards(speed=speed), restitution=0.95)
    # until two to three steps before it meets the first ball
    while data.qpos[0] < data.qpos[7] - 2 * cm.POOL.radius - 3 * 0.002 * speed:
        mujoco.mj_step(model, data)
    before, time = data.qvel[0], data.time
    assert before > 0.9 * speed
    mujoco.mj_step(model, data, 4)
    found = velocities(data)[:, 0]
    places = data.xipos[1:]
    for place, velocity in zip(places, found, strict=True):
        mirror = np.argmin(np.abs(places - place * (1, -1, 1)).sum(axis=1))
        # the order in which contacts are solved tells left from right: to the
        # tolerance of the law
        np.testing.assert_allclose(
            velocity * (1, -1, 1), found[mirror], rtol=0, atol=1e-4 * speed
        )
    # at most the cloth under 16 balls takes some away: mu g t each
    lost = before - found[:, 0].sum()
    assert 0 <= lost < 16 * 0.2 * G * (data.time - time)
    # all balls move
    assert np.linalg.norm(found, axis=1).min() > 0.01


def test_a_ball_slides_until_it_rolls_with_five_sevenths_of_its_speed():
    xml = cm.billiards(0, speed=1.0, rolling=0.0, length=6.0)
    model, data = released(xml, restitution=0.9)
    # sliding ends after 2/7 v / (mu g) = 0.15 s
    step_past(model, data, 0.4)
    velocity, spin = velocities(data)[0]
    # MuJoCo's soft friction lets it slip by 0.6 % for ever
    assert velocity[0] == pytest.approx(5 / 7, abs=5e-3)
    assert cm.POOL.radius * spin[1] == pytest.approx(5 / 7, abs=5e-3)


def test_rolling_resistance_and_the_decay_of_spin_are_those_asked_for():
    model, data = released(cm.billiards(0, rolling=0.02), restitution=0.9)
    data.qvel[:] = 1.0, 0.0, 0.0, 0.0, 1.0 / cm.POOL.radius, 0.0
    step_past(model, data, 0.2)
    early = data.qvel[0]
    step_past(model, data, 0.7)
    assert (early - data.qvel[0]) / 0.5 == pytest.approx(0.02 * G, rel=0.01)
    mujoco.mj_resetData(model, data)
    data.qvel[5] = 50.0
    step_past(model, data, 1.0)
    # 10 rad/s^2, as told by Alciatore for pool balls
    assert data.qvel[5] == pytest.approx(40.0, rel=0.01)


def test_a_cushion_above_the_centre_keeps_a_rolling_ball_on_the_table():
    """That is why cushions are that high: friction lifts a ball that rolls at them."""
    highest = {}
    for nose in (0.0, 0.27):
        model, data = released(cm.billiards(0, nose=nose), restitution=0.8)
        data.qpos[0] = 1.0
        data.qvel[:] = 2.0, 0.0, 0.0, 0.0, 2.0 / cm.POOL.radius, 0.0
        heights = []
        while data.time < 0.3:
            mujoco.mj_step(model, data)
            heights.append(data.qpos[2] - cm.POOL.radius)
        assert data.qvel[0] < -0.5
        highest[nose] = max(heights)
    # mu (1 + e) v = 0.5 m/s upwards would be 13 mm
    assert highest[0.0] > 0.010
    # what is left is its rebound from the bed, that the cushion presses it on
    assert highest[0.27] < 0.6 * highest[0.0]


@pytest.mark.parametrize(("x", "y"), [(0.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
def test_a_ball_that_meets_a_pocket_falls_in_and_stays(x, y):
    model, data = released(cm.billiards(0), restitution=0.5)
    corner = np.array([x * 1.27, y * 0.635])
    inwards = np.array([-x, -y]) / math.hypot(x, y)
    data.qpos[:2] = corner + 0.2 * inwards
    data.qvel[:2] = -1.0 * inwards
    step_past(model, data, 1.5)
    assert data.qpos[2] < -0.08
    assert np.abs(data.qpos[:2]).max() < 1.4


# --------------------------------------------------------------------- dominoes


def test_the_wave_of_dominoes_does_not_depend_on_the_timestep():
    arrival = {}
    for timestep in (0.002, 0.0005):
        xml = cm.dominoes(8, timestep=timestep)
        model, data = released(xml, restitution=0.3)
        last = data.body("stone_8")
        # an angular velocity of 1 rad/s: struck
        deepest = 0.0
        while abs(last.cvel[1]) < 1.0:
            mujoco.mj_step(model, data)
            deepest = min(deepest, *data.contact.dist)
            assert data.time < 1.0
        arrival[timestep] = data.time
        # MuJoCo's contacts alone let them 4 mm into each other, of 8 mm
        assert deepest > -5e-4
    # steps of 2 ms tell the time to half a step, 0.3 % of it
    assert arrival[0.002] == pytest.approx(arrival[0.0005], rel=0.015)


# When the last of eight stones has turned by 0.05 rad [s], for pushes of the first
# [rad/s]: stiff contacts with friction in the plane, steps of 10 us
# (mujoco_impact_lab.bench.friction.falling).
ARRIVALS = {
    3.6: 0.52807, 3.7: 0.52070, 3.8: 0.51388, 3.9: 0.50816, 4.0: 0.50278,
    4.1: 0.49757, 4.2: 0.49320, 4.3: 0.48876, 4.4: 0.48485,
}  # fmt: skip


def test_the_wave_of_dominoes_arrives_when_that_of_stiff_contacts_does():
    """Whose impacts rattle on for a millisecond, and must be solved to their end."""
    errors = []
    for push, expected in ARRIVALS.items():
        xml = cm.dominoes(8, timestep=0.001)
        model, data = released(xml, restitution=0.3)
        data.qvel *= push / data.qvel[4]
        tilt = before = 0.0
        while tilt < 0.05:
            mujoco.mj_step(model, data)
            before, tilt = tilt, 2 * math.asin(data.qpos[-2])
            assert data.time < 1.0
        part = (tilt - 0.05) / (tilt - before)
        time = data.time - part * model.opt.timestep
        errors.append(time / expected - 1)
    # RMS 8e-4, as good as the times are; 2.5e-3 if impacts are ended short of work
    assert np.sqrt(np.mean(np.square(errors))) < 1.8e-3


# ---------------------------------------------------------------- rocking block


@pytest.mark.parametrize(
    ("half_height", "time", "apex"),
    # Housner's block of half width 0.1 m, let go at half of alpha: when it is upright
    # for the first time [s], and how far it then leans to the other side [rad];
    # integrated from his equation, (4/3) R omega' = -g sin(alpha - theta)
    [
        (0.4, 0.312308575113, 0.0947367931208),
        (0.2, 0.231044027917, 0.0956508360198),
    ],
)
def test_a_rocking_block_leans_as_far_as_housner_says(half_height, time, apex):
    xml = cm.rocking_block(half_width=0.1, half_height=half_height, half_depth=0.1)
    model, data = released(xml, restitution=0)
    leans, times = [], []
    while data.time < 3 * time:
        mujoco.mj_step(model, data)
        leans.append(2 * math.asin(data.qpos[5]))
        times.append(data.time)
    lean = np.array(leans)
    first = times[int(np.argmax(lean < 0))]
    # steps of 2 ms
    assert first == pytest.approx(time, rel=0.01)
    # it turns on MuJoCo's soft floor, which gives way by 0.1 mm at every change of edge
    assert -lean.min() == pytest.approx(apex, rel=0.06)


# --------------------------------------------------------------- Galilean cannon


@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_a_cannon_shoots_as_hertz_integrated(gap):
    height = 0.4
    model, data = released(cm.cannon(height=height, gap=gap), restitution=1)
    centres = data.qpos.reshape(-1, 7)[:, :3].copy()
    fall = np.array([0.0, 0.0, -G])
    spheres = [
        Sphere(ball.mass, ball.radius, centre, np.zeros(3), fall, np.eye(3))
        for ball, centre in zip(cm.CANNON, centres, strict=True)
    ]
    floor = Plane(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    step_past(model, data, math.sqrt(2 * height / G) + 0.01)
    truth = sphere_velocities(spheres, [floor], data.time, rtol=1e-8)
    speed = math.sqrt(2 * G * height)
    found = velocities(data)[:, 0]
    # contacts of 0.1 ms, in fractions of the speed of the fall: what is left is the
    # gravity of that time
    np.testing.assert_allclose(found / speed, truth / speed, rtol=0, atol=4e-4)
    # in touch they hinder each other; one after the other they shoot the top one up
    assert (found[2, 2] > 4 * speed) == (gap > 0)


# ----------------------------------------------------------- Bernoulli's problem


@pytest.mark.parametrize("count", [2, 3, 4, 5])
@pytest.mark.parametrize(("mu", "e"), [(0.0, 1.0), (0.0, 0.5), (0.1, 1.0), (0.3, 0.5)])
def test_one_ball_strikes_several_at_once_as_one_contact(count, mu, e):
    """All contacts are alike, so each is a contact in the plane of its line and x."""
    model, data = released(cm.bernoulli(count, friction=mu), restitution=e)
    mass, radius = cm.A.mass, cm.A.radius
    # the angle between the way of the striker and a line of centres
    sine = 1 / (2 * math.sin(math.pi / count))
    cosine = math.sqrt(1 - sine**2)
    w_n = (1 + count * cosine**2) / mass
    w_t = (3.5 + count * sine**2) / mass
    x = -count * cosine * sine / mass
    W = np.array([[w_n, x], [x, w_t]])
    normal, tangential = keller.impulses(-cosine, sine, W, mu, e)
    striker = 1.0 - count * (normal * cosine - tangential * sine) / mass
    # of a struck ball: along x, and away from the axis
    ahead = (normal * cosine - tangential * sine) / mass
    aside = (normal * sine + tangential * cosine) / mass
    spin = 2.5 * tangential / mass
    step_past(model, data, 0.05 + 0.006)
    found = velocities(data)
    # the law is integrated to 1e-5 of the impact speed, 1 m/s
    assert found[0, 0, 0] == pytest.approx(striker, abs=3e-5)
    np.testing.assert_allclose(found[1:, 0, 0], ahead, rtol=0, atol=3e-5)
    away = np.linalg.norm(found[1:, 0, 1:], axis=1)
    np.testing.assert_allclose(away, abs(aside), rtol=0, atol=3e-5)
    turning = radius * np.linalg.norm(found[1:, 1], axis=1)
    np.testing.assert_allclose(turning, abs(spin), rtol=0, atol=3e-5)
    assert found[:, 0].sum(axis=0) == pytest.approx([1.0, 0.0, 0.0], abs=1e-10)
