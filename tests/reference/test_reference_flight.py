"""Free pendulums in closed form, against integration, and their first contact."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import cradle_models as cm
from mujoco_impact import reference

# DOP853 at rtol 1e-13 over a few seconds: a few 1e-12; large angles are steeper.
INTEGRATED = 1e-10


def integrated(
    angle: float, velocity: float, frequency: float, times: NDArray[np.float64]
) -> NDArray[np.float64]:
    solution = solve_ivp(
        lambda _, s: [s[1], -(frequency**2) * np.sin(s[0])],
        (0, times[-1]),
        [angle, velocity],
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
        t_eval=times,
    )
    return np.asarray(solution.y)


@pytest.mark.parametrize(
    ("angle", "velocity"),
    [
        (-0.5, 0.0),
        (0.0, 3.0),
        (-3.0, 0.0),
        (0.3, -2.0),
        (1e-6, 1e-6),
        (0.2, 14.0),
        (-2.0, -12.0),
        (7.0, 1.0),
    ],
    ids=str,
)
def test_free_flight_solves_the_pendulum_equation(
    angle: float, velocity: float
) -> None:
    frequency = 5.7
    times = np.linspace(0, 3, 61)
    found = reference.free_flight(
        np.array([angle]), np.array([velocity]), np.array([frequency]), times
    )
    scale = max(abs(angle), abs(velocity), 1e-6)
    expected = integrated(angle, velocity, frequency, times)
    tolerance = INTEGRATED * max(1.0, scale) if scale > 1e-3 else 1e-15
    np.testing.assert_allclose(found[0][:, 0], expected[0], atol=tolerance)
    np.testing.assert_allclose(found[1][:, 0], expected[1], atol=10 * tolerance)


def test_a_quarter_of_the_period_is_the_complete_elliptic_integral() -> None:
    frequency, lifted = np.array([5.0]), np.array([-2.5])
    quarter = ellipk(np.sin(1.25) ** 2) / 5.0
    angle, velocity = reference.free_flight(
        lifted, np.zeros(1), frequency, np.array([quarter, 2 * quarter])
    )
    np.testing.assert_allclose(angle[:, 0], [0.0, 2.5], atol=1e-14)
    np.testing.assert_allclose(velocity[:, 0], [10 * np.sin(1.25), 0.0], atol=1e-13)


def test_flying_back_undoes_flying_forth() -> None:
    chain = reference.Chain.of(cm.balls("AABA"))
    angles = np.array([-1.0, 0.3, 0.0, 2.9])
    velocities = np.array([2.0, -1.0, 0.0, 5.0])
    there = reference.free_flight(angles, velocities, chain.frequency, 0.73)
    back = reference.free_flight(*there, chain.frequency, -0.73)
    np.testing.assert_allclose(back[0], angles, atol=1e-13)
    np.testing.assert_allclose(back[1], velocities, atol=1e-12)


def test_a_hanging_row_stays_exactly_where_it_is() -> None:
    rest = np.zeros(2)
    for state in reference.free_flight(rest, rest, np.full(2, 5.0), np.arange(3.0)):
        assert not state.any()


def test_mujoco_swings_a_ball_of_the_models_like_the_reference() -> None:
    """Same moment of inertia, same sign of the angle."""
    model = mujoco.MjModel.from_xml_string(
        cm.row("B", integrator="RK4", timestep=1e-3, release=40)
    )
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    chain = reference.Chain.of(cm.balls("B"))
    start = reference.release_state(chain, 40, 1)
    for _ in range(4):
        mujoco.mj_step(model, data, 200)
        angle, velocity = reference.free_flight(*start, chain.frequency, data.time)
        # RK4 at 1 ms: (w h)^4 / 120 per radian of phase, 1e-11.
        np.testing.assert_allclose(data.qpos, angle, atol=1e-9)
        np.testing.assert_allclose(data.qvel, velocity, atol=1e-8)


def test_equal_balls_meet_at_the_bottom_after_a_quarter_period() -> None:
    chain = reference.Chain.of(cm.balls("AAA"))
    start = reference.release_state(chain, 30, 1)
    expected = ellipk(np.sin(np.pi / 12) ** 2) / chain.frequency[0]
    found = reference.time_to_contact(chain, *start, 1.0)
    # A pair presses 1e-14 m after it touches.
    assert pytest.approx(expected, abs=1e-13) == found
    assert reference.time_to_contact(chain, *start, 0.9 * expected) is None


def test_a_short_dip_between_two_samples_is_found() -> None:
    """Two balls that swing apart and back in phase touch for 4 ms only."""
    chain = reference.Chain.of(cm.balls("AB"), gap=0.01)
    angles = np.array([-0.2, 0.2])
    after = 0.25 * 2 * np.pi / chain.frequency[0]

    def lowest(gap: float) -> tuple[float, float]:
        trial = reference.Chain.of(cm.balls("AB"), gap=gap)
        times = np.linspace(0, 2 * after, 20_001)
        angle, _ = reference.free_flight(angles, velocities, trial.frequency, times)
        separation = trial.separation(angle)[:, 0]
        return float(separation.min()), float(times[separation.argmin()])

    velocities = np.array([0.5, -0.5])
    touching = 0.01 - lowest(0.01)[0]
    for _ in range(20):
        touching -= lowest(touching)[0]
    dip = 1e-7
    grazing = reference.Chain.of(cm.balls("AB"), gap=touching - dip)
    found = reference.time_to_contact(grazing, angles, velocities, 2 * after)
    assert found is not None
    assert pytest.approx(lowest(touching - dip)[1], abs=1e-3) == found
    missing = reference.Chain.of(cm.balls("AB"), gap=touching + dip)
    assert reference.time_to_contact(missing, angles, velocities, 2 * after) is None


def test_one_ball_touches_nothing() -> None:
    chain = reference.Chain.of(cm.balls("A"))
    assert reference.time_to_contact(chain, np.ones(1), np.ones(1), 5.0) is None


@pytest.mark.parametrize(
    ("gap", "speed"), [(-1e-6, -0.01), (-1e-6, 0.0), (-1.5e-14, 1.0), (0.0, 1.0)]
)
def test_balls_that_press_at_the_start_are_in_contact_at_once(
    gap: float, speed: float
) -> None:
    chain = reference.Chain.of(cm.balls("AB"), gap=gap)
    closing = np.array([speed, -speed])
    found = reference.time_to_contact(chain, np.zeros(2), closing, 1.0)
    # Touching balls are pressed by 1e-14 m that much later.
    assert found is not None
    assert 0 <= found < 1e-13
