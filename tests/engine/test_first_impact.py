"""Velocities after the first impact against published integrations of the Hertz law."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, free_row, pendulums

import cradle_models
from mujoco_impact import metrics, reference

# scipy DOP853 (rtol 1e-12, atol 1e-14, event restart) of straight rows of steel balls,
# A 115 g / 15.0 mm, B 230 g / 19.05 mm; velocities over that of the incoming ball
HERTZ = {
    "AAA": [-0.070952353650, 0.076403039070, 0.994549314580],
    "AAAAA": [
        -0.071085017087,
        -0.030273764097,
        -0.014463629032,
        0.127044986068,
        0.988777424147,
    ],
    "BAA": [0.161981, 0.316976, 1.359062],
    "ABA": [-0.361986, 0.249614, 0.862758],
    "BAB": [-0.136123, 0.355828, 0.958209],
}

# the same of the Liu-Zhao-Brogliato law, bi-stiffness, e = .9
LOSSY = {
    "AAA": [-0.008615356155, 0.104142798515, 0.904472557640],
    "AAAAA": [
        -0.008670629407,
        0.023776871553,
        0.033065561424,
        0.124262570389,
        0.827565626040,
    ],
    "BAA": [0.216060, 0.324584, 1.243297],
    "ABA": [-0.291007688834, 0.253107331182, 0.784793026469],
    "BAB": [-0.057816, 0.371930, 0.871851],
}


# On arms of 1 m a row of pendulums is a straight row to 5e-5 v0, by 2/5 (r/L)^2 of the
# inertia. On arms of .3 m it is not, by up to 5.6e-4 (BAB): test_row_accuracy compares
# those with the reference of the same pendulums.
LENGTH = 1.0


def after_first_impact(pattern, integrator, timestep, **options):
    """Returns the velocities 100 ms after the impact, flown back to it, over v0."""
    model, data = pendulums(
        pattern,
        integrator=integrator,
        timestep=timestep,
        length=LENGTH,
        **options,
    )
    times, angles, velocities = [0.0], [data.qpos.copy()], [data.qvel.copy()]
    for _ in range(round(0.7 / timestep)):
        mujoco.mj_step(model, data)
        times.append(data.time)
        angles.append(data.qpos.copy())
        velocities.append(data.qvel.copy())
    chain = reference.Chain.of(cradle_models.balls(pattern), length=LENGTH)
    samples = (np.array(times), np.array(angles), np.array(velocities))
    if integrator != "RK4":
        samples = metrics.euler_half_step(*samples, chain, timestep=timestep)
    return metrics.velocity_after_first_impact(*samples, chain)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize(("timestep", "tolerance"), [(0.002, 5e-4), (0.005, 2e-3)])
@pytest.mark.parametrize("pattern", HERTZ)
def test_elastic_rows_leave_the_impact_as_hertz_says(
    pattern, integrator, timestep, tolerance
):
    left = after_first_impact(pattern, integrator, timestep)
    assert np.abs(left - HERTZ[pattern]).max() < tolerance


def test_rows_that_overlap_by_rounding_leave_the_impact_as_those_that_touch():
    """At the depth of other scenes MuJoCo pushes them apart, and it is off by .02."""
    left = after_first_impact("AAA", "Euler", 0.002, gap=-1e-6)
    assert np.abs(left - HERTZ["AAA"]).max() < 5e-4


@pytest.mark.parametrize("pattern", LOSSY)
def test_bistiffness_rows_leave_the_impact_as_lzb_says(pattern):
    left = after_first_impact(pattern, "Euler", 0.002, restitution=0.9)
    assert np.abs(left - LOSSY[pattern]).max() < 1e-3


def test_the_error_falls_with_the_square_of_the_timestep():
    errors = [
        np.abs(after_first_impact("AAA", "Euler", h) - HERTZ["AAA"]).max()
        for h in (0.01, 0.005, 0.0025)
    ]
    # second order divides by 4; where in the step the impact falls halves that at worst
    assert errors[0] > 1.8 * errors[1] > 1.8**2 * errors[2]


def test_a_ball_that_arrives_exactly_at_the_end_of_a_step_is_not_missed():
    """A closing at the last instant of a step belongs to the next one, at its start."""
    model, data = free_row([0.1, 0.1], speed=1.0, start=0.008, timestep=0.002)
    for _ in range(10):
        mujoco.mj_step(model, data)
    assert data.qvel[6] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_equal_balls_swap_any_velocities(integrator):
    """To rounding.

    Also those of which the numbers of the state, times their places in it, have the
    same sum before and after: by it stages of Runge-Kutta were told apart.
    """
    for speeds in ((4.0, -0.5), (2.0, -0.25), (3.0, 0.0), (1.0, -0.5)):
        model, data = free_row([0.1, 0.1], integrator=integrator, start=0.01)
        data.qvel[[0, 6]] = speeds
        while data.time < 0.02:
            mujoco.mj_step(model, data)
        np.testing.assert_allclose(data.qvel[[6, 0]], speeds, rtol=0, atol=1e-12)
