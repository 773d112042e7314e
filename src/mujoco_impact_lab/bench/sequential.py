"""Instantaneous impacts of one pair after another: the ideal cradle of textbooks.

Free pendulums in closed form until two balls meet; then the pairs that close exchange
momentum from left to right, again and again until none closes. Its run time is that of
Python and not comparable.
"""

from __future__ import annotations

import time

import numpy as np

from mujoco_impact.errors import SimulationError
from mujoco_impact.reference import Chain, free_flight, time_to_contact
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.methods import Candidate, MethodFamily
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP, VELOCITY_DELAY, BenchScene
from mujoco_impact_lab.bench.truths import Truth

STILL = 1e-12
"""Closing speed up to which two balls go on together, in fractions of the fastest
ball's: rounding would let them bounce for ever."""

TOUCHING = 1e-9
"""Gap that counts as closed [m]."""

MOST_EVENTS = 10_000


class SequentialSimulation:
    """A row under instantaneous pairwise impacts."""

    def __init__(self, scene: BenchScene, truth: Truth) -> None:
        """Prepares a scene; only the first impact of one without a known swing."""
        self._chain = truth.chain
        self._restitution = scene.restitution
        self._start = scene.start()
        short = truth.onset + VELOCITY_DELAY + 0.01
        self._duration = scene.duration if truth.motion is not None else short
        self._share = self._duration / scene.duration

    def record(self) -> Samples:
        """Runs once, with a sample every 2 ms."""
        count = round(self._duration / BASE_TIMESTEP) + 1
        times = np.arange(count, dtype=np.float64) * BASE_TIMESTEP
        angles = np.zeros((count, self._chain.count))
        velocities = np.zeros_like(angles)
        now, (angle, velocity) = 0.0, self._start
        for _ in range(MOST_EVENTS):
            left = self._duration - now
            wait = time_to_contact(self._chain, angle, velocity, left)
            length = left if wait is None else wait
            inside = (times >= now) & (times <= now + length + 1e-12)
            flight = self._fly(angle, velocity, times[inside] - now)
            angles[inside], velocities[inside] = flight
            if wait is None:
                return Samples(times, angles, velocities)
            angle, velocity = self._fly(angle, velocity, wait)
            velocity = collide(self._chain, angle, velocity, self._restitution)
            angle = part(self._chain, angle)
            now += wait
        msg = f"more than {MOST_EVENTS} impacts within {now:.4g} s"
        raise SimulationError(msg, time=now)

    def run_time(self) -> float:
        """Runs once; returns the wall-clock time [s], scaled to the whole duration."""
        begin = time.perf_counter()
        self.record()
        return (time.perf_counter() - begin) / self._share

    def _fly(
        self, angle: Array, velocity: Array, elapsed: Array | float
    ) -> tuple[Array, Array]:
        return free_flight(angle, velocity, self._chain.frequency, elapsed)


def collide(
    chain: Chain, angles: Array, velocities: Array, restitution: float
) -> Array:
    """Returns the velocities after pairwise impacts of the balls that touch [rad/s].

    Args:
        chain: The row.
        angles: Angles [rad], shape (n,).
        velocities: Angular velocities before [rad/s], shape (n,).
        restitution: Coefficient of restitution of each impact.
    """
    gap, left, right = chain.contacts(angles)
    velocity = velocities.copy()
    # equal arms: torque impulses P G_a and P G_b change the velocities by P G / I
    mobility = left**2 / chain.inertia[:-1] + right**2 / chain.inertia[1:]
    limit = STILL * float(np.abs(velocity).max()) * chain.length
    touching = np.flatnonzero(gap <= TOUCHING)
    for _ in range(MOST_EVENTS):
        quiet = True
        for k in touching:
            closing = -(left[k] * velocity[k] + right[k] * velocity[k + 1])
            if closing <= 0:
                continue
            bounce = restitution if closing > limit else 0.0
            impulse = (1 + bounce) * closing / mobility[k]
            velocity[k] += impulse * left[k] / chain.inertia[k]
            velocity[k + 1] += impulse * right[k] / chain.inertia[k + 1]
            quiet = quiet and closing <= limit
        if quiet:
            return velocity
    msg = f"the balls still close after {MOST_EVENTS} rounds of pairwise impacts"
    raise SimulationError(msg, time=0.0)


def part(chain: Chain, angles: Array) -> Array:
    """Returns the angles with overlaps (of rounding size) taken out [rad].

    Args:
        chain: The row.
        angles: Angles [rad], shape (n,).
    """
    angle = angles.copy()
    for k in range(chain.count - 1):
        overlap = -float(chain.separation(angle)[k])
        if 0 < overlap < TOUCHING:
            angle[k + 1] += overlap / chain.length
    return angle


def family() -> MethodFamily:
    """Returns the ideal cradle as a method."""
    candidate = Candidate(
        "sequential",
        "pairwise impacts, left to right",
        None,
        "exact",
        SequentialSimulation,
        comparable=False,
        quick=True,
        rows_only=True,
    )
    return MethodFamily(
        "sequential", "sequential impacts (reference, Python)", (candidate,)
    )
