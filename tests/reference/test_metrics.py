"""The metrics on trajectories whose errors are known beforehand."""

import numpy as np
import pytest
from numpy.typing import NDArray

import cradle_models as cm
from mujoco_impact import metrics, reference
from mujoco_impact.errors import ImpactError

FloatArray = NDArray[np.float64]

TRUTH = (-0.0709523536498, 0.0764030390697, 0.99454931458)


@pytest.fixture(scope="module")
def truth() -> reference.ReferenceTrajectory:
    return reference.pendulum_row(cm.balls("AAA"), duration=1.2)


@pytest.fixture(scope="module")
def times() -> FloatArray:
    return 0.002 * np.arange(600.0)


def test_a_perfect_trajectory_has_no_error(
    truth: reference.ReferenceTrajectory, times: FloatArray
) -> None:
    found = metrics.row_errors(times, *truth(times), truth)
    assert found.velocity < 1e-14
    assert found.velocity_max < 1e-14
    assert found.angle_rms == 0
    assert found.velocity_rms == 0
    # The last sample is in free flight: only the integration error is left.
    assert abs(found.energy_drift) < 1e-9


def test_the_velocities_after_the_impact_are_those_of_the_hertz_chain(
    truth: reference.ReferenceTrajectory, times: FloatArray
) -> None:
    found = metrics.velocity_after_first_impact(times, *truth(times), truth.chain)
    # The straight-line impact has no gravity: 1e-6 during 0.15 ms.
    np.testing.assert_allclose(found, TRUTH, atol=1e-5)


@pytest.mark.parametrize("delay", [0.001, 0.02, 0.05, 0.2])
def test_the_delay_at_which_the_state_is_taken_does_not_matter(
    truth: reference.ReferenceTrajectory, delay: float
) -> None:
    times = np.arange(0, 1.2, 0.0005)
    base, other = (
        metrics.velocity_after_first_impact(times, *truth(times), truth.chain, delay=d)
        for d in (0.1, delay)
    )
    # Exact propagation: the floor of the metric is rounding.
    np.testing.assert_allclose(other, base, atol=1e-12)


def test_an_error_of_momentum_is_charged_in_full(
    truth: reference.ReferenceTrajectory, times: FloatArray
) -> None:
    """A made-up engine that leaves (0, 0, 1) behind."""
    chain = truth.chain
    onset = truth.contact_intervals[0, 0]
    angles, velocities = truth(times)
    at = truth([onset])
    made = np.array([0.0, 0.0, at[1][0, 0]])
    after = times > onset
    angles[after], velocities[after] = reference.free_flight(
        np.zeros(3), made, chain.frequency, times[after] - onset
    )
    expected = np.sqrt(np.mean((np.array([0, 0, 1]) - TRUTH) ** 2))
    until = times < 0.6
    found = metrics.row_errors(times[until], angles[until], velocities[until], truth)
    assert pytest.approx(expected, abs=1e-5) == found.velocity
    assert pytest.approx(0.0764, abs=1e-4) == found.velocity_max
    assert found.angle_rms > 0.01
    assert found.velocity_rms > 0.05


def test_a_constant_shift_of_the_angles_is_the_angle_error(
    truth: reference.ReferenceTrajectory, times: FloatArray
) -> None:
    angles, velocities = truth(times)
    assert pytest.approx(2e-3) == metrics.angle_rms(times, angles + 2e-3, truth)
    shifted = metrics.velocity_rms(times, velocities - 0.01, truth)
    assert pytest.approx(0.01) == shifted


def test_samples_during_a_contact_do_not_count_in_the_velocity_error(
    truth: reference.ReferenceTrajectory,
) -> None:
    inside = truth.contact_intervals.mean(axis=1)
    times = np.sort(np.concatenate((np.linspace(0, 1, 50), inside)))
    _, velocities = truth(times)
    velocities[np.isin(times, inside)] += 100
    assert metrics.velocity_rms(times, velocities, truth) == 0
    with pytest.raises(metrics.MetricError, match="in contact at every sample"):
        metrics.velocity_rms(inside, truth(inside)[1], truth)


def test_scaled_velocities_change_the_energy_by_the_square(
    truth: reference.ReferenceTrajectory, times: FloatArray
) -> None:
    at = [0, int(np.argmin(np.abs(times - 0.2796)))]
    angles, velocities = (values[at] for values in truth(times))
    velocities[1] *= 0.9
    # At the bottom nearly all energy is kinetic.
    found = metrics.energy_drift(angles, velocities, truth.chain)
    assert pytest.approx(0.81 - 1, abs=1e-4) == found


def euler(
    chain: reference.Chain,
    timestep: float,
    steps: int,
    start: tuple[FloatArray, FloatArray],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """MuJoCo's semi-implicit Euler step for free pendulums."""
    angles, velocities = [start[0]], [start[1]]
    for _ in range(steps):
        velocities.append(
            velocities[-1] + timestep * chain.free_acceleration(angles[-1])
        )
        angles.append(angles[-1] + timestep * velocities[-1])
    return timestep * np.arange(steps + 1.0), np.array(angles), np.array(velocities)


def errors_of_euler(timestep: float, corrected: bool) -> tuple[float, float]:
    chain = reference.Chain.of(cm.balls("A"))
    start = reference.release_state(chain, 30, 1)
    samples = euler(chain, timestep, round(1.0 / timestep), start)
    if corrected:
        samples = metrics.euler_half_step(*samples, chain, timestep=timestep)
    time, angle, velocity = samples
    true = reference.free_flight(*start, chain.frequency, time)
    return float(np.abs(angle - true[0]).max()), float(np.abs(velocity - true[1]).max())


def test_euler_is_of_first_order_and_its_half_step_state_of_second() -> None:
    for corrected, order in ((False, 1), (True, 2)):
        coarse = errors_of_euler(0.004, corrected)
        fine = errors_of_euler(0.002, corrected)
        # The velocities are of second order either way.
        assert pytest.approx(order, abs=0.05) == np.log2(coarse[0] / fine[0])
        assert pytest.approx(2, abs=0.15) == np.log2(coarse[1] / fine[1])
    # h^2 / 8 of an acceleration of 16 rad/s^2, and the phase error (w h)^2 / 24.
    assert errors_of_euler(0.002, True)[0] < 2e-5
    assert errors_of_euler(0.002, False)[0] > 2e-3


def test_an_ideal_impact_under_euler_is_only_charged_for_second_order() -> None:
    """The exact impact between two Euler steps, as a perfect plugin would give it."""
    truth = reference.pendulum_row(cm.balls("AAA"), duration=0.5)
    chain = truth.chain
    timestep = 0.002
    time, angles, velocities = euler(
        chain, timestep, 225, reference.release_state(chain, 30, 1)
    )
    before = int(np.argmax(angles[:, 0] > 0)) - 1
    share = -angles[before, 0] / (angles[before + 1, 0] - angles[before, 0])
    speed = velocities[before + 1, 0]
    left = np.array(TRUTH) * speed
    rest = (1 - share) * timestep * left, left
    tail = euler(chain, timestep, 225 - before - 1, rest)
    angles = np.concatenate((angles[: before + 1], tail[1]))
    velocities = np.concatenate((velocities[: before + 1], tail[2]))
    samples = metrics.euler_half_step(
        time, angles, velocities, chain, timestep=timestep
    )
    found = metrics.row_errors(*samples, truth)
    raw = metrics.row_errors(time, angles, velocities, truth)
    assert found.velocity < 2e-5
    # In truth the last ball lags: half of 0.15 ms at 3 rad/s, one ball in three, for
    # two fifths of the time. Uncorrected Euler is ahead by 1 ms.
    assert found.angle_rms < 1.5e-4
    assert raw.angle_rms > 1e-3


def test_rows_without_an_impact_or_too_short_are_refused(
    truth: reference.ReferenceTrajectory, times: FloatArray
) -> None:
    angles, velocities = truth(times)
    with pytest.raises(metrics.MetricError, match="no two balls touch"):
        metrics.velocity_after_first_impact(
            times[:50], angles[:50], velocities[:50], truth.chain
        )
    with pytest.raises(metrics.MetricError, match=r"0\.1 s after the impact at 0\.27"):
        metrics.velocity_after_first_impact(
            times[:150], angles[:150], velocities[:150], truth.chain
        )
    with pytest.raises(ImpactError, match=r"needed: \(600, 3\)"):
        metrics.row_errors(times, angles[:, :2], velocities, truth)
    with pytest.raises(metrics.MetricError, match="without energy"):
        metrics.energy_drift(np.zeros((2, 3)), np.zeros((2, 3)), truth.chain)
