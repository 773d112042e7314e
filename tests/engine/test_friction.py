"""Friction by equations (7)-(9): off by default, as printed, and passive."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, header, step_until_delivered

import cradle_models
import mujoco_impact
from mujoco_impact.calibration.objective import Candidates, Objective
from mujoco_impact.calibration.shots import Shots

MASS, RADIUS = 0.115, 0.015
ALONG, DOWN = 0.3, 0.5  # velocity of the ball [m/s]

FLOOR = """
<mujoco>
  <option timestep="{timestep}" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1" condim="1"/>
    <body pos="0 0 .0153"><freejoint/>
      <geom name="ball" size=".015" mass=".115" condim="1"/>
    </body>
  </worldbody>
</mujoco>
"""


def bounced(*, timestep=1e-3, integrator="Euler", along=ALONG, **settings):
    """The ball after it has hit the floor at an angle; model and data."""
    xml = FLOOR.format(timestep=timestep, integrator=integrator)
    spec = mujoco_impact.attach(xml, gap=0.02, depth=0.01, **settings)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[:3] = along, 0, -DOWN
    step_until_delivered(model, data)
    return model, data


def stepped_friction(N, T, P, mu_s, mu_d, steps=20000):
    """Equations (7)-(9), step by step, each late by a step at a change of mode."""
    before, ds = T, P / steps
    for _ in range(steps):
        if mu_s * abs(N) < T:
            T = max(0.0, T - mu_d * ds)
        N -= ds
    return before - T


@pytest.mark.parametrize(
    ("mu_s", "mu_d"),
    [(0.0, 0.05), (0.1, 0.05), (0.3, 0.05), (0.7, 0.02), (0.9, 0.2)],
)
@pytest.mark.parametrize("duration", ["hertz", 5e-3])
def test_an_oblique_bounce_loses_what_the_equations_say(mu_s, mu_d, duration):
    """v_x falls by Q/m, and the ball spins by r Q / (2/5 m r^2)."""
    _, data = bounced(
        friction="paper", mu_s=mu_s, mu_d=mu_d, duration=duration, passive=False
    )
    P = 2 * MASS * DOWN  # elastic
    Q = stepped_friction(MASS * DOWN, MASS * ALONG, P, mu_s, mu_d)
    late = 4 * P / 20000
    assert data.qvel[0] == pytest.approx(ALONG - Q / MASS, abs=late / MASS)
    assert data.qvel[2] == pytest.approx(DOWN, rel=1e-9)
    spin = Q * RADIUS / (0.4 * MASS * RADIUS**2)
    assert data.qvel[4] == pytest.approx(spin, abs=late / (0.4 * MASS * RADIUS))
    assert np.abs(data.qvel[[1, 3, 5]]).max() < 1e-9  # rounding


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
@pytest.mark.parametrize("timestep", [2e-4, 2e-3, 5e-3])
def test_the_tangential_impulse_does_not_depend_on_the_timestep(integrator, timestep):
    settings = {"friction": "paper", "mu_s": 0.1, "mu_d": 0.05, "duration": 5e-3}
    fine = bounced(timestep=1e-4, **settings)[1].qvel
    assert integrator in INTEGRATORS
    found = bounced(timestep=timestep, integrator=integrator, **settings)[1].qvel
    # the plane of the floor does not turn: rounding
    np.testing.assert_allclose(found, fine, rtol=0, atol=1e-10)


def test_without_slip_or_factors_nothing_changes_by_a_bit():
    plain = bounced()[1].qvel
    smooth = bounced(friction="paper", mu_s=0.2, mu_d=0.0)[1].qvel
    np.testing.assert_array_equal(smooth, plain)
    assert plain[0] == ALONG  # off by default
    straight = bounced(along=0.0, friction="paper", mu_s=0.1, mu_d=0.5)[1].qvel
    np.testing.assert_array_equal(straight[[0, 1, 3, 4, 5]], np.zeros(5))


def test_as_printed_it_can_add_energy_and_the_guard_stops_it():
    """All slip momentum taken, Q = m v_x: the spin has 2.5 times the energy lost."""
    energy = {}
    for passive in (False, True):
        model, data = bounced(friction="paper", mu_s=0.0, mu_d=0.9, passive=passive)
        mujoco.mj_energyVel(model, data)
        energy[passive] = data.energy[1] / (0.5 * MASS * (ALONG**2 + DOWN**2))
    # v_x = 0, spin 5/4 m v_x^2: (.125 + .1125) / .17 by hand
    assert energy[False] == pytest.approx(0.2375 / 0.17, rel=1e-6)
    assert energy[True] == pytest.approx(1, abs=1e-9)


def oblique_row(pattern="AAA", **settings):
    """A row of free balls; the first comes in with slip. Model and data."""
    balls = cradle_models.balls(pattern)
    x, bodies = 0.0, ""
    for i, ball in enumerate(balls):
        x += ball.radius
        bodies += (
            f'<body pos="{x - (1e-4 if i == 0 else 0)!r} 0 0"><freejoint/>'
            f'<geom name="ball{i}" size="{ball.radius}" mass="{ball.mass}"/></body>'
        )
        x += ball.radius
    xml = (
        '<mujoco><option timestep=".0005" gravity="0 0 0"/><default><geom condim="1"/>'
        f"</default><worldbody>{bodies}</worldbody></mujoco>"
    )
    model = mujoco_impact.attach(xml, gap=0.02, depth=0.014, **settings).compile()
    data = mujoco.MjData(model)
    data.qvel[:3] = 0.5, 0.02, -0.01
    return model, data


@pytest.mark.parametrize("pattern", ["AAA", "BAB"])
def test_the_simulation_does_what_the_calibration_assumes(pattern):
    """Change of momentum of three balls, equations (6)-(12), as it is evaluated."""
    settings = {"sh": 200.0, "sw": 0.5, "alpha": (1.2, 1.0)}
    # short pulses: the balls hardly move along while they last
    model, data = oblique_row(
        pattern, law="calibrated", duration=1e-5, passive=False, friction="paper",
        mu_s=0.01, mu_d=0.02, **settings,
    )  # fmt: skip
    before = data.qvel.reshape(3, 6)[:, :3].copy()
    step_until_delivered(model, data)
    masses = np.array([ball.mass for ball in cradle_models.balls(pattern)])
    found = masses[:, None] * (data.qvel.reshape(3, 6)[:, :3] - before)
    # the ball flies for .2 ms: the line of centres turns by that of the lateral flight
    flight = 1e-4 / 0.5 * before[0]
    line = flight * [0, 1, 1] * -1 + [2 * cradle_models.balls(pattern)[0].radius, 0, 0]
    n = np.array([line / np.linalg.norm(line), [1.0, 0.0, 0.0]])
    shots = Shots(masses, before[None], before[None], n[None])
    one = Candidates(*(np.array([v]) for v in (200.0, 0.5, 0.01, 0.02)),
                     np.array([[1.2, 1.0]]))  # fmt: skip
    expected = Objective(shots).impulses(one)[0, 0]
    assert np.abs(expected[0, 1:]).max() > 1e-4  # there is friction
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-6)


def test_momentum_and_angular_momentum_are_conserved():
    model, data = oblique_row(friction="paper", mu_s=0.05, mu_d=0.3, duration=2e-3)

    def totals():
        mujoco.mj_comVel(model, data)
        mujoco.mj_subtreeVel(model, data)
        centre = data.subtree_com[0]
        p = 0.115 * data.qvel.reshape(3, 6)[:, :3].sum(axis=0)
        return np.concatenate([p, data.subtree_angmom[0] + np.cross(centre, p)])

    mujoco.mj_forward(model, data)
    before = totals()
    step_until_delivered(model, data)
    mujoco.mj_forward(model, data)
    after = totals()
    np.testing.assert_allclose(after[:3], before[:3], rtol=0, atol=1e-14)
    # both forces of a pulse act in one point up to the overlap while it lasts
    spin = np.abs(data.qvel.reshape(3, 6)[:, 3:]).max() * 0.4 * MASS * RADIUS**2
    assert spin > 1e-6
    np.testing.assert_allclose(after[3:], before[3:], rtol=0, atol=0.05 * spin)


def test_the_sensor_counts_the_tangential_force():
    """Force times timestep, summed, is the change of momentum: rounding."""
    xml = FLOOR.format(timestep=1e-3, integrator="Euler")
    spec = mujoco_impact.attach(
        xml, gap=0.02, depth=0.01, friction="paper", mu_s=0.1, mu_d=0.1, duration=5e-3
    )
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[:3] = ALONG, 0, -DOWN
    total = np.zeros(3)
    for _ in range(60):
        mujoco.mj_step(model, data)
        total += data.sensordata[:3] * 1e-3
    assert header(model, data).active == 0
    change = MASS * (data.qvel[:3] - [ALONG, 0, -DOWN])
    np.testing.assert_allclose(total, change, rtol=0, atol=1e-14)
    assert change[0] < -1e-4


def test_repeated_forward_changes_nothing():
    settings = {"friction": "paper", "mu_s": 0.1, "mu_d": 0.1, "duration": 5e-3}
    once = bounced(**settings)[1]
    xml = FLOOR.format(timestep=1e-3, integrator="Euler")
    model = mujoco_impact.attach(xml, gap=0.02, depth=0.01, **settings).compile()
    data = mujoco.MjData(model)
    data.qvel[:3] = ALONG, 0, -DOWN
    while not header(model, data).count or header(model, data).active:
        mujoco.mj_forward(model, data)
        mujoco.mj_step(model, data)
    np.testing.assert_array_equal(data.qvel, once.qvel)
