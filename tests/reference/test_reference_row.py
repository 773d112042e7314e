"""The motion of a whole row: impacts, energy, independent integration."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import cradle_models as cm
from mujoco_impact import reference


@pytest.fixture(scope="module")
def three() -> reference.ReferenceTrajectory:
    return reference.pendulum_row(cm.balls("AAA"))


def test_energy_is_conserved_over_three_seconds(
    three: reference.ReferenceTrajectory,
) -> None:
    assert three.duration == 3.0
    # rtol 1e-12 and some thousand steps; rounding of the angles at the contacts.
    assert abs(three.energy_drift) < 1e-9
    chain = three.chain
    energy = chain.energy(*three(np.linspace(0, 3, 301)))
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)


def test_the_first_impact_leaves_the_velocities_of_the_hertz_chain(
    three: reference.ReferenceTrajectory,
) -> None:
    start, stop = three.contact_intervals[0]
    _, (before, after) = three([start, stop])
    # DOP853 on a straight line, rtol 1e-12; gravity takes part in the 0.146 ms of the
    # pendulums' impact with some 1e-6.
    expected = (-0.0709523536498, 0.0764030390697, 0.99454931458)
    np.testing.assert_allclose(after / before[0], expected, atol=1e-5)
    assert pytest.approx(0.146e-3, abs=1e-6) == stop - start


def test_the_motion_is_continuous_where_flights_and_contacts_meet(
    three: reference.ReferenceTrajectory,
) -> None:
    edges = three.contact_intervals.ravel()
    edges = edges[(edges > 0) & (edges < 3)]
    assert len(edges) >= 10
    just_before, just_after = three(edges - 1e-12), three(edges + 1e-12)
    # Speeds of 3 rad/s, forces that begin with zero.
    np.testing.assert_allclose(just_before[0], just_after[0], atol=1e-11)
    np.testing.assert_allclose(just_before[1], just_after[1], atol=1e-9)


def test_balls_are_compressed_exactly_during_the_contact_intervals(
    three: reference.ReferenceTrajectory,
) -> None:
    times = np.linspace(0, 3, 5001)
    times = np.concatenate((times, three.contact_intervals.mean(axis=1)))
    angles, _ = three(times)
    compressed = three.chain.separation(angles).min(axis=1) < -1e-13
    np.testing.assert_array_equal(compressed, three.in_contact(times))
    assert compressed[-len(three.contact_intervals) :].all()


def test_the_motion_is_that_of_a_plain_integration_of_the_forces() -> None:
    """RK45 in Cartesian geometry, through flight and impact without events."""
    row = cm.balls("BA")
    mass = np.array([0.230, 0.115])
    radius = np.array([0.01905, 0.015])
    inertia = mass * 0.3**2 + 0.4 * mass * radius**2
    stiffness = (
        4 / 3 * 2e11 / (2 * 0.91) * np.sqrt(radius[0] * radius[1] / radius.sum())
    )

    def rates(_: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        a, b = state[:2]
        x = radius.sum() + 0.3 * (np.sin(b) - np.sin(a))
        z = 0.3 * (np.cos(a) - np.cos(b))
        force = stiffness * max(radius.sum() - np.hypot(x, z), 0.0) ** 1.5
        normal = np.array([x, z]) / np.hypot(x, z)
        torque = -mass * 9.81 * 0.3 * np.sin(state[:2])
        torque[0] -= force * 0.3 * normal @ [np.cos(a), np.sin(a)]
        torque[1] += force * 0.3 * normal @ [np.cos(b), np.sin(b)]
        return np.concatenate((state[2:], torque / inertia))

    times = np.linspace(0, 0.5, 26)
    plain = solve_ivp(
        rates,
        (0, 0.5),
        [-np.radians(20), 0, 0, 0],
        method="RK45",
        rtol=1e-9,
        atol=1e-12,
        max_step=1e-3,
        t_eval=times,
    )
    found = reference.pendulum_row(row, release=20, duration=0.5)
    assert len(found.contact_intervals) == 1
    angles, velocities = found(times)
    # RK45 at rtol 1e-9 over the impact.
    np.testing.assert_allclose(angles, plain.y[:2].T, atol=1e-7)
    np.testing.assert_allclose(velocities, plain.y[2:].T, atol=1e-6)


def test_a_tighter_tolerance_changes_little(
    three: reference.ReferenceTrajectory,
) -> None:
    times = np.linspace(0, 3, 301)
    looser = reference.pendulum_row(cm.balls("AAA"), rtol=1e-10)
    assert np.abs(looser(times)[0] - three(times)[0]).max() < 1e-7


def test_wide_gaps_give_the_sequential_cradle() -> None:
    found = reference.pendulum_row(cm.balls("AAA"), gap=1e-4, duration=0.4)
    assert len(found.contact_intervals) == 2
    start = found.contact_intervals[0, 0]
    stop = found.contact_intervals[-1, 1]
    _, (before, after) = found([start, stop])
    # Between the two impacts the middle ball rises by (1e-4 m / 0.3 m)^2.
    np.testing.assert_allclose(after / before[0], (0, 0, 1), atol=1e-4)


def test_released_balls_that_hang_alike_fall_together_without_touching() -> None:
    found = reference.pendulum_row(cm.balls("AAAA"), released=2, duration=0.29)
    assert len(found.contact_intervals) == 1
    angles, _ = found(np.linspace(0, 0.27, 50))
    np.testing.assert_array_equal(angles[:, 0], angles[:, 1])


def test_a_row_that_starts_compressed_springs_apart_and_keeps_its_energy() -> None:
    found = reference.pendulum_row(
        cm.balls("AA"), gap=-1e-6, release=0, released=0, duration=0.1
    )
    assert found.contact_intervals[0, 0] == 0
    assert found.contact_intervals[0, 1] < 1e-3
    _, velocities = found([0.01])
    assert velocities[0, 0] < 0 < velocities[0, 1]
    assert abs(found.energy_drift) < 1e-8


def test_a_row_at_rest_stays_at_rest() -> None:
    found = reference.pendulum_row(cm.balls("ABA"), released=0, duration=1.0)
    assert not np.any(found(np.linspace(0, 1, 11)))
    assert found.contact_intervals.shape == (0, 2)
    assert np.isnan(found.energy_drift)


def test_a_row_can_start_in_any_state() -> None:
    chain = reference.Chain.of(cm.balls("AB"))
    found = reference.swing(chain, [0.0, 0.0], [1.0, -1.0], 0.01)
    assert found.contact_intervals[0, 0] < 1e-12
    momentum = found([0.0, 0.005])[1] @ np.array(chain.masses)
    # Gravity acts for 5 ms on angles of 2e-3.
    assert pytest.approx(momentum[0], rel=2e-2) == momentum[1]


def test_times_outside_the_trajectory_are_refused(
    three: reference.ReferenceTrajectory,
) -> None:
    for times in ([-0.1], [1.0, 3.1]):
        with pytest.raises(reference.ChainError, match=r"allowed: 0 to 3\.0"):
            three(times)
    assert three(1500 * np.array([0.002]))[0].shape == (1, 3)
