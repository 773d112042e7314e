"""Bodies overlap no deeper than their depth, however long or soft an impact is."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact
from mujoco_impact.pulses import PulseReader

RADIUS, MASS = 0.01, 0.1

SCENE = """
<mujoco>
  <option timestep="{timestep}" gravity="0 0 0" integrator="{integrator}"/>
  <default><joint type="slide" axis="1 0 0"/></default>
  <worldbody>{balls}</worldbody>
</mujoco>
"""


def shot(masses, speed, *, timestep=1e-3, integrator="Euler", depth, steps=200, gap=0,
         **settings):  # fmt: skip
    """A ball comes at a row; returns velocities, deepest overlap, pulses, pushes."""
    pitch = 2 * RADIUS + gap
    xs = [-2 * RADIUS - 1.5 * speed * timestep] + [
        pitch * i for i in range(len(masses) - 1)
    ]
    balls = "".join(
        f'<body pos="{x!r} 0 0"><joint/><geom size="{RADIUS}" mass="{mass}"/></body>'
        for x, mass in zip(xs, masses, strict=True)
    )
    xml = SCENE.format(balls=balls, timestep=timestep, integrator=integrator)
    model = mujoco_impact.attach(
        xml, depth=depth, gap=3 * speed * timestep, **settings, friction="none"
    ).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = speed
    reader = PulseReader(model, data)
    deepest, pushes = 0.0, 0
    for _ in range(steps):
        mujoco.mj_step(model, data)
        reader.poll()
        pushes += bool(np.any(data.efc_force))
        between = np.diff(np.array(xs) + data.qpos)
        deepest = max(deepest, 2 * RADIUS - between.min())
    return data.qvel.copy(), deepest, reader.impacts, pushes


DEPTH = 0.002
"""Of each geom [m]: contacts are the plugin's down to twice that."""


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_fixed_pulse_is_as_short_as_the_depth_asks_for(integrator):
    # at 2 m/s a pulse of 50 ms would let them overlap by 32 mm, more than through
    velocity, deepest, impacts, pushes = shot(
        [MASS, MASS], 2.0, duration=0.05, depth=DEPTH, integrator=integrator
    )
    assert pushes == 0
    assert 0.2 * DEPTH < deepest <= 2 * DEPTH
    assert impacts[0].duration < 0.05
    # the impulse is what it was: equal balls hand the velocity on
    np.testing.assert_allclose(velocity, [0, 2], atol=1e-12)


def test_a_fixed_pulse_that_fits_is_left_as_it_is():
    _, deepest, impacts, pushes = shot([MASS, MASS], 0.1, duration=0.05, depth=DEPTH)
    assert pushes == 0
    assert impacts[0].duration == 0.05
    # u W/π of a half sine that reverses the closing speed; the steps see most of it
    assert deepest == pytest.approx(0.1 * 0.05 / np.pi, rel=2e-2)


@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.0])
def test_bodies_too_soft_for_their_depth_do_not_press_through(restitution):
    """A Hertz contact of rubber at 5 m/s would be 5 mm deep and last 3 ms."""
    velocity, deepest, _, pushes = shot(
        [MASS, MASS], 5.0, timestep=1e-4, young=1e6, restitution=restitution, depth=1e-4
    )
    assert pushes == 0
    assert deepest <= 2e-4
    after = [2.5 * (1 - restitution), 2.5 * (1 + restitution)]
    np.testing.assert_allclose(velocity, after, atol=1e-9)


@pytest.mark.parametrize("light", [1e-2, 1e-4])
def test_a_light_ball_is_not_thrown_through_its_neighbours(light):
    """The pulses on its two sides last several steps and are not the same."""
    velocity, deepest, _, pushes = shot(
        [MASS, light * MASS, MASS], 0.1, timestep=2e-5, young=1e8, depth=DEPTH / 10,
        steps=500,
    )  # fmt: skip
    assert pushes == 0
    assert deepest <= 2 * DEPTH / 10
    energy = 0.5 * MASS * np.array([1, light, 1]) @ velocity**2
    # the law scales elastic impacts to conserve energy to rounding
    assert energy == pytest.approx(0.5 * MASS * 0.1**2, rel=1e-9)


@pytest.mark.parametrize("young", [2e11, 1e7])
@pytest.mark.parametrize("restitution", [1.0, 0.9, 0.5, 0.0])
def test_what_an_impact_does_does_not_depend_on_the_depth(restitution, young):
    """Not how long it lasts either: 1 µm is less than steel is pressed, or dented."""
    options = {"restitution": restitution, "young": young, "timestep": 2e-3, "steps": 8}
    deep = shot([MASS] * 4, 0.5, depth=1e-4, **options)
    flat = shot([MASS] * 4, 0.5, depth=1e-6, **options)
    assert not flat[3]  # pushes
    # the impulses are the law's to the bit; the rest is rounding of other positions
    np.testing.assert_allclose(flat[0], deep[0], rtol=0, atol=1e-12)
    for one, other in zip(flat[2], deep[2], strict=True):
        assert one.impulse == pytest.approx(other.impulse, rel=1e-9)
        assert one.duration == pytest.approx(other.duration, rel=1e-6)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_contact_in_which_a_pulse_presses_is_ours_however_deep(integrator):
    """Deeper than the depth MuJoCo has rows for it; they must not push."""
    velocity, deepest, impacts, pushes = shot(
        [MASS, MASS], 0.1, duration=5e-3, depth=1e-6, integrator=integrator
    )
    assert not pushes
    assert deepest > 1e-4
    assert impacts[0].duration == 5e-3
    np.testing.assert_allclose(velocity, [0, 0.1], atol=1e-12)


@pytest.mark.parametrize("restitution", [0.9, 0.0])
def test_dents_are_not_left_to_mujocos_contact(restitution):
    """A row that lost energy lies closed, pressed by less than the depth."""
    velocity, deepest, _, pushes = shot(
        [MASS] * 5, 0.5, timestep=2e-3, restitution=restitution, depth=1e-6, steps=3
    )
    assert not pushes
    assert deepest <= 2e-6
    # all the momentum is still there
    assert velocity.sum() == pytest.approx(0.5, rel=1e-12)


def test_a_ball_that_a_pulse_throws_at_another_strikes_it_in_the_same_step():
    """When the step begins they part; what closes them comes within it."""
    h, pulse, speeds, gap = 1e-3, 1.2e-3, (1.0, 0.0, 0.2), 1e-5
    onset = 0.7 * h
    xs = [-2 * RADIUS - speeds[0] * onset, 0, 2 * RADIUS + gap]
    balls = "".join(
        f'<body pos="{x!r} 0 0"><joint/><geom size="{RADIUS}" mass="{MASS}"/></body>'
        for x in xs
    )
    xml = SCENE.format(balls=balls, timestep=h, integrator="Euler")
    # stiff, or the law would take both impacts for one
    model = mujoco_impact.attach(
        xml, depth=DEPTH, gap=0.01, duration=pulse, young=1e14, friction="none"
    ).compile()
    data = mujoco.MjData(model)
    data.qvel[:] = speeds
    reader = PulseReader(model, data)
    for _ in range(2):
        mujoco.mj_step(model, data)
        reader.poll()
    # the contact that closed is not left to the step after
    first, second = reader.impacts
    assert first.time == pytest.approx(onset, rel=1e-9)
    # .15 m/s after the first step, when the third is .2 mm ahead with .2 m/s
    assert 1.5 * h < second.time < 2 * h


def test_short_fixed_pulses_are_resolved_one_after_the_other():
    """A pulse of a hundredth of a step: several impacts in one step, with gaps."""
    velocity, _, impacts, pushes = shot(
        [MASS] * 4, 5.0, timestep=5e-3, duration=5e-5, depth=DEPTH, gap=0.004, steps=8
    )
    assert pushes == 0
    assert len(impacts) == 3
    np.testing.assert_allclose(velocity, [0, 0, 0, 5], atol=1e-9)
    times = [impact.time for impact in impacts]
    # the flight of 4 mm at 5 m/s, from the middle of the pulse before
    np.testing.assert_allclose(np.diff(times), 0.8e-3 + 0.5 * 5e-5, rtol=1e-9)


def test_plastic_balls_that_stay_together_let_the_next_one_be_struck():
    """Contacts that close by rounding alone must not use up the rounds of a step."""
    velocity, _, _, pushes = shot(
        [MASS] * 5, 100.0, timestep=2e-3, restitution=0.0, depth=DEPTH, steps=60
    )
    assert pushes == 0
    np.testing.assert_allclose(velocity, 20.0, rtol=1e-4)


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_runge_kutta_stages_do_not_wake_mujocos_contacts(speed):
    """In mid-step balls are where no impact has happened yet: u h/2, through others."""
    velocity, _, _, _ = shot(
        [MASS, MASS, MASS], speed, timestep=5e-3, integrator="RK4", depth=1e-4, steps=12
    )
    energy = 0.5 * MASS * np.sum(velocity**2)
    assert energy == pytest.approx(0.5 * MASS * speed**2, rel=1e-12)
    assert velocity.sum() == pytest.approx(speed, rel=1e-13)


@pytest.mark.parametrize(
    ("speed", "young", "timestep", "depth"),
    [(1.0, 1e5, 1e-5, 3e-4), (20.0, 1e7, 1e-6, 5e-4), (5.0, 1e6, 1e-5, 1e-4)],
)
@pytest.mark.parametrize("light", [1.0, 0.2])
def test_soft_bodies_are_no_stiffer_than_their_depth_asks_for(
    light, speed, young, timestep, depth
):
    """Steps far shorter than the impact show all of the overlap."""
    steps = round(0.02 / speed / timestep)
    hard, _, _, _ = shot([MASS, light * MASS, MASS], speed, depth=depth, steps=99)
    soft, deepest, _, _ = shot(
        [MASS, light * MASS, MASS], speed, timestep=timestep, young=young, depth=depth,
        steps=steps,
    )  # fmt: skip
    # half of M is 1: as soft as half as much again would be five times too stiff
    # or 4 % of 1/(1/R1 + 1/R2), if that is more
    assert 0.2 * depth < deepest <= max(depth, 0.04 * RADIUS / 2)
    # the outcome of bodies that touch does not depend on how stiff they are
    np.testing.assert_allclose(soft, hard, atol=1e-5 * speed)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.8])
def test_dents_do_not_grow_with_the_number_of_impacts(restitution):
    """Soft balls with losses between two heavy ones that press them together."""
    gap = 2e-4
    _, deepest, impacts, pushes = shot(
        [100 * MASS, MASS, MASS, MASS, 100 * MASS], 2.0, timestep=2e-4, young=1e6,
        restitution=restitution, depth=1e-3, gap=gap, steps=400,
    )  # fmt: skip
    assert len(impacts) > 3
    assert pushes == 0
    # bodies are pressed by at most half of 1/(1/R1 + 1/R2)
    assert deepest <= 0.26 * RADIUS


@pytest.mark.parametrize(
    ("settings", "depth"),
    [
        ({}, 1e-7),
        ({"young": 4e6}, 1e-6),
        ({"assign": {"ball": "rubber"}}, 1e-6),
        ({"assign": {"ball": "steel"}}, 1e-7),
    ],
)
def test_soft_bodies_get_a_deeper_default(settings, depth):
    """Their contacts outlast steps, and MuJoCo would push what overlaps meanwhile."""
    xml = """
    <mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body pos="0 0 1"><freejoint/><geom name="ball" size=".1"/></body>
    </worldbody></mujoco>"""
    assert mujoco_impact.attach(xml, **settings).geom("ball").margin == -depth
