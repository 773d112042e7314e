"""How far a simulated pendulum row is from the Hertz reference.

Angles are positive towards +x, as in `mujoco_impact.reference` and in the models of
`cradle_models`. Samples are arrays: times [s], shape (t,), angles [rad] and angular
velocities [rad/s], both of shape (t, n).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mujoco_impact.errors import ImpactError
from mujoco_impact.reference import (
    Chain,
    ReferenceTrajectory,
    free_flight,
    time_to_contact,
)
from mujoco_impact.reference.chain import FloatArray


class MetricError(ImpactError, ValueError):
    """A metric is not defined for these samples."""


@dataclass(frozen=True)
class RowErrors:
    """Differences between a simulated row and its reference.

    Attributes:
        velocity: RMS over the balls of the velocities after the first impact, in
            fractions of the impact speed.
        velocity_max: The largest of these differences.
        angle_rms: RMS over balls and time [rad].
        velocity_rms: RMS over balls and time of the angular velocities, samples during
            contacts of the reference left out [rad/s].
        energy_drift: Change of kinetic and gravity energy from the first to the last
            sample, in fractions of the first.
    """

    velocity: float
    velocity_max: float
    angle_rms: float
    velocity_rms: float
    energy_drift: float


def euler_half_step(
    times: ArrayLike,
    angles: ArrayLike,
    velocities: ArrayLike,
    chain: Chain,
    *,
    timestep: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Turn samples of MuJoCo's semi-implicit Euler into a state of second order.

    The step v(n+1) = v(n) + h a(q(n)), q(n+1) = q(n) + h v(n+1) is the leapfrog scheme:
    with w(n+1/2) = v(n+1) it reads w(n+1/2) = w(n-1/2) + h a(q(n)) and
    q(n+1) = q(n) + h w(n+1/2), and leapfrog follows a true trajectory Q, V up to terms
    of order h^2 if w(n+1/2) belongs to the middle between the times of q(n) and q(n+1).
    A start from rest, v(0) = 0, sets w(-1/2) = 0: the balls rest half a step *before*
    the time that belongs to q(0). So if Q is let go at time 0 and t(n) = n h, then

        q(n) = Q(t(n) + h/2) + O(h^2),    v(n) = V(t(n)) + O(h^2),
        v(n) + h/2 a(q(n)) = V(t(n) + h/2) + O(h^2).

    Taken at t(n), the angles are ahead by h/2 times the velocity: 1.2e-3 rad RMS at
    2 ms for a cradle lifted by 30 degrees, more than the error of a good impact. This
    function returns the state at t(n) + h/2 instead. An impact in the step from n to
    n + 1 shows in q(n+1) and v(n+1) and in neither q(n) nor v(n), so it falls between
    the new times, too. Only for rows that start at rest.

    Args:
        times: Times [s], shape (t,).
        angles: Angles [rad], shape (t, n).
        velocities: Angular velocities [rad/s], shape (t, n).
        chain: The row, for its free acceleration a.
        timestep: Timestep h of the simulation [s]; samples may be further apart.

    Returns:
        Times, angles and velocities, shapes as given.

    Raises:
        MetricError: The shapes do not fit.
    """
    time, angle, velocity = _samples(times, angles, velocities, chain)
    half = 0.5 * timestep
    return time + half, angle, velocity + half * chain.free_acceleration(angle)


def velocity_after_first_impact(
    times: ArrayLike,
    angles: ArrayLike,
    velocities: ArrayLike,
    chain: Chain,
    *,
    delay: float = 0.1,
    onset: float | None = None,
) -> FloatArray:
    """Return the velocities left by the first impact, in fractions of its speed.

    The first sample not earlier than `delay` after first contact is propagated back to
    that instant as free pendulums. For balls that have separated this is exact; for an
    engine whose contacts last tens of milliseconds it removes the effect of gravity and
    still charges all errors of momentum.

    Args:
        times: Times [s], shape (t,).
        angles: Angles [rad], shape (t, n).
        velocities: Angular velocities [rad/s], shape (t, n).
        chain: The row.
        delay: Time after first contact at which the state is taken [s].
        onset: Time of the impact [s]. None: when the first sample, moving as free
            pendulums, first has two balls press on each other.

    Returns:
        Angular velocity over that of the fastest ball just before the impact,
        shape (n,).

    Raises:
        MetricError: The samples hold no impact, or end too early after it.
    """
    time, angle, velocity = _samples(times, angles, velocities, chain)
    if onset is None:
        span = float(time[-1] - time[0])
        wait = time_to_contact(chain, angle[0], velocity[0], span)
        if wait is None:
            raise MetricError(f"no two balls touch within the {span} s of the samples")
        onset = float(time[0]) + wait
    later = np.flatnonzero(time >= onset + delay - 1e-12)
    if not later.size:
        raise MetricError(
            f"samples end at {time[-1]} s; needed: {delay} s after the impact at "
            f"{onset} s"
        )
    at = later[0]
    frequency = chain.frequency
    before = free_flight(angle[0], velocity[0], frequency, onset - time[0])[1]
    after = free_flight(angle[at], velocity[at], frequency, onset - time[at])[1]
    fractions: FloatArray = after / np.abs(before).max()
    return fractions


def angle_rms(
    times: ArrayLike, angles: ArrayLike, reference: ReferenceTrajectory
) -> float:
    """Return the RMS difference of the angles over balls and time [rad].

    Args:
        times: Times [s], shape (t,), within the reference.
        angles: Angles [rad], shape (t, n).
        reference: The truth.
    """
    return _rms(np.asarray(angles, dtype=float) - reference(times)[0])


def velocity_rms(
    times: ArrayLike, velocities: ArrayLike, reference: ReferenceTrajectory
) -> float:
    """Return the RMS difference of the velocities over balls and time [rad/s].

    Samples at which the reference is in contact are left out.

    Args:
        times: Times [s], shape (t,), within the reference.
        velocities: Angular velocities [rad/s], shape (t, n).
        reference: The truth.
    """
    free = ~reference.in_contact(times)
    difference = np.asarray(velocities, dtype=float) - reference(times)[1]
    if not free.any():
        raise MetricError("the reference is in contact at every sample")
    return _rms(difference[free])


def energy_drift(angles: ArrayLike, velocities: ArrayLike, chain: Chain) -> float:
    """Return the change of energy from the first to the last sample, over the first.

    Kinetic and gravity energy; what a contact stores at the end does not count, since
    every engine stores it differently.

    Args:
        angles: Angles [rad], shape (t, n).
        velocities: Angular velocities [rad/s], shape (t, n).
        chain: The row.
    """
    angle = np.asarray(angles, dtype=float)[[0, -1]]
    velocity = np.asarray(velocities, dtype=float)[[0, -1]]
    first, last = chain.mechanical_energy(angle, velocity)
    if first <= 0:
        raise MetricError("the row starts without energy; its drift has no scale")
    return float((last - first) / first)


def row_errors(
    times: ArrayLike,
    angles: ArrayLike,
    velocities: ArrayLike,
    reference: ReferenceTrajectory,
    *,
    delay: float = 0.1,
) -> RowErrors:
    """Return all errors of a simulated row that starts like its reference.

    Samples after the end of the reference are left out (`euler_half_step` moves the
    last one there).

    Args:
        times: Times [s], shape (t,).
        angles: Angles [rad], shape (t, n).
        velocities: Angular velocities [rad/s], shape (t, n).
        reference: The truth.
        delay: See `velocity_after_first_impact`.
    """
    chain = reference.chain
    time, angle, velocity = _samples(times, angles, velocities, chain)
    kept = time <= reference.duration
    time, angle, velocity = time[kept], angle[kept], velocity[kept]
    truth = reference(time)
    difference = velocity_after_first_impact(
        time, angle, velocity, chain, delay=delay
    ) - velocity_after_first_impact(time, *truth, chain, delay=delay)
    return RowErrors(
        velocity=_rms(difference),
        velocity_max=float(np.abs(difference).max()),
        angle_rms=angle_rms(time, angle, reference),
        velocity_rms=velocity_rms(time, velocity, reference),
        energy_drift=energy_drift(angle, velocity, chain),
    )


def _rms(values: FloatArray) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def _samples(
    times: ArrayLike, angles: ArrayLike, velocities: ArrayLike, chain: Chain
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the samples as arrays, checked against each other."""
    time = np.asarray(times, dtype=float)
    angle = np.asarray(angles, dtype=float)
    velocity = np.asarray(velocities, dtype=float)
    shape = (len(time), chain.count)
    if not len(time) or angle.shape != shape or velocity.shape != shape:
        raise MetricError(
            f"angles have shape {angle.shape} and velocities {velocity.shape}; needed: "
            f"{shape}, one row for each time and one column for each ball"
        )
    return time, angle, velocity
