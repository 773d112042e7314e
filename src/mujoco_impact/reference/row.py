"""The Hertz reference of a pendulum row: free flights and contacts in turn.

Between impacts every ball is a free pendulum, known in closed form; while any pair is
compressed, the equations of motion of the whole row are integrated by DOP853,

    I_i a_i'' = -m_i g L sin a_i + sum over the pairs of ball i of K delta^1.5 dG/da_i,

G the gap of the pair as a function of the angles and delta = max(-G, 0). There is no
friction and no damping, so energy is conserved up to the integration error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from mujoco_impact.reference.chain import (
    BallLike,
    Chain,
    ChainError,
    FloatArray,
    contact_time,
    release_state,
)
from mujoco_impact.reference.flight import TOUCH, free_flight, time_to_contact

#: More phases than this mean that the row does not separate any more.
MOST_PHASES = 100_000

#: Angles and angular velocities, each of shape (t, n), at times since a phase began.
Motion = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class Phase:
    """A part of a trajectory: one free flight, or one contact of any pairs.

    Attributes:
        start: Time at which it begins [s].
        stop: Time at which it ends [s].
        contact: Whether any pair is compressed.
        motion: The motion at times since `start`.
    """

    start: float
    stop: float
    contact: bool
    motion: Motion


@dataclass(frozen=True)
class ReferenceTrajectory:
    """The motion of a row from time 0 on, to be evaluated at any time.

    Attributes:
        chain: The row.
        phases: Free flights and contacts in order of time, without holes.
    """

    chain: Chain
    phases: tuple[Phase, ...]

    @property
    def duration(self) -> float:
        """Time at which the trajectory ends [s]."""
        return self.phases[-1].stop

    @cached_property
    def contact_intervals(self) -> FloatArray:
        """Starts and ends [s] of the times when any pair touches, shape (k, 2)."""
        intervals = [
            (phase.start, phase.stop) for phase in self.phases if phase.contact
        ]
        return np.array(intervals, dtype=float).reshape(-1, 2)

    @cached_property
    def energy_drift(self) -> float:
        """Change of energy from start to end, in fractions of the energy at the start.

        Energy stored in a compressed contact counts. NaN for a row without energy.
        """
        first, last = self.chain.energy(*self([0.0, self.duration]))
        return float((last - first) / first) if first > 0 else math.nan

    def __call__(self, times: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return angles [rad] and angular velocities [rad/s], each of shape (t, n).

        Args:
            times: Times [s], shape (t,), within 0 and `duration`.

        Raises:
            ChainError: A time lies outside the trajectory.
        """
        time = np.asarray(times, dtype=float)
        # Times such as 1500 * 0.002 miss the end by a rounding.
        slack = 1e-12 * self.duration
        if time.size and not (
            (time >= -slack).all() and (time <= self.duration + slack).all()
        ):
            raise ChainError(
                f"times {time.min()} to {time.max()} s; allowed: 0 to {self.duration} s"
            )
        starts = np.array([phase.start for phase in self.phases])
        index = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, None)
        angles = np.empty((len(time), self.chain.count))
        velocities = np.empty_like(angles)
        for i in np.unique(index):
            chosen = index == i
            phase = self.phases[i]
            local = np.clip(time[chosen], phase.start, phase.stop) - phase.start
            angles[chosen], velocities[chosen] = phase.motion(local)
        return angles, velocities

    def in_contact(self, times: ArrayLike) -> np.ndarray:
        """Return whether any pair touches at each of the times [s], shape (t,)."""
        time = np.asarray(times, dtype=float)[:, np.newaxis]
        start, stop = self.contact_intervals.T
        inside: np.ndarray = ((start <= time) & (time <= stop)).any(axis=1)
        return inside


def pendulum_row(
    balls: Sequence[BallLike],
    *,
    length: float = 0.3,
    release: float = 30.0,
    released: int = 1,
    duration: float = 3.0,
    gap: float | Sequence[float] = 0.0,
    young: float = 2e11,
    poisson: float = 0.3,
    gravity: float = 9.81,
    rtol: float = 1e-12,
) -> ReferenceTrajectory:
    """Return the motion of a row of steel balls let go at the left.

    Args:
        balls: Balls, left to right, such as ``cradle_models.balls("BAA")``.
        length: Distance from pivot to centre [m].
        release: Angle by which the released balls are lifted [deg].
        released: Number of balls lifted, from the left.
        duration: Time to cover [s].
        gap: Gap between hanging neighbours [m], one for all or one for each pair.
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        gravity: Gravity [m/s^2].
        rtol: Relative tolerance of the integration of contacts, 1e-13 to 1e-3.

    Raises:
        ChainError: A parameter lies outside its range.
    """
    chain = Chain.of(
        balls, gap=gap, length=length, young=young, poisson=poisson, gravity=gravity
    )
    return swing(chain, *release_state(chain, release, released), duration, rtol=rtol)


def swing(
    chain: Chain,
    angles: ArrayLike,
    velocities: ArrayLike,
    duration: float,
    *,
    rtol: float = 1e-12,
) -> ReferenceTrajectory:
    """Return the motion of a row from any state.

    Args:
        chain: The row.
        angles: Angles at time 0 [rad], shape (n,).
        velocities: Angular velocities at time 0 [rad/s], shape (n,).
        duration: Time to cover [s], positive.
        rtol: Relative tolerance of the integration of contacts, 1e-13 to 1e-3.

    Raises:
        ChainError: A parameter lies outside its range, or the row does not
            separate any more.
    """
    if not (np.isfinite(duration) and duration > 0):
        raise ChainError(f"duration = {duration} s; allowed: finite and > 0")
    if not 1e-13 <= rtol <= 1e-3:
        raise ChainError(f"rtol = {rtol}; allowed: 1e-13 to 1e-3")
    angle = np.array(angles, dtype=float)
    velocity = np.array(velocities, dtype=float)
    phases: list[Phase] = []
    now = 0.0
    while now < duration:
        if len(phases) > MOST_PHASES:
            raise ChainError(
                f"more than {MOST_PHASES} flights and contacts up to {now} s: "
                "the balls stay together"
            )
        flight = not (phases and not phases[-1].contact)
        make = _flight if flight else _contact
        motion, length = make(chain, angle, velocity, duration - now, rtol)
        if length > 0:
            phases.append(Phase(now, min(now + length, duration), not flight, motion))
            state = motion(np.array([length]))
            angle, velocity = state[0][0], state[1][0]
            now = duration if now + length >= duration else now + length
        elif flight:
            # The row starts compressed: go on with a contact.
            phases.append(Phase(now, now, False, motion))
    return ReferenceTrajectory(chain, tuple(phases))


def _flight(
    chain: Chain,
    angles: FloatArray,
    velocities: FloatArray,
    horizon: float,
    rtol: float,  # noqa: ARG001 (exact; same signature as _contact)
) -> tuple[Motion, float]:
    """Return the free motion, and when it ends at a contact or the horizon [s]."""
    end = time_to_contact(chain, angles, velocities, horizon)

    def motion(time: FloatArray) -> tuple[FloatArray, FloatArray]:
        return free_flight(angles, velocities, chain.frequency, time)

    return motion, horizon if end is None else end


def _contact(
    chain: Chain,
    angles: FloatArray,
    velocities: FloatArray,
    horizon: float,
    rtol: float,
) -> tuple[Motion, float]:
    """Return the motion while any pair is compressed, and when that ends [s].

    The state is (a - angles, a'): small differences keep their digits.
    """
    from scipy.integrate import solve_ivp

    count = chain.count

    def rates(_: float, state: FloatArray) -> FloatArray:
        angle = angles + state[:count]
        gap, left, right = chain.contacts(angle)
        compression = np.maximum(-gap, 0.0)
        force = chain.stiffness * compression * np.sqrt(compression)
        torque = -chain.weight_torque * np.sin(angle)
        torque[:-1] += force * left
        torque[1:] += force * right
        return np.concatenate((state[count:], torque / chain.inertia))

    def pressed(_: float, state: FloatArray) -> float:
        return float(-chain.separation(angles + state[:count]).min() - TOUCH)

    pressed.terminal = True  # type: ignore[attr-defined]
    pressed.direction = -1  # type: ignore[attr-defined]
    speed = max(float(np.abs(velocities).max()), 1e-9)
    scale = _impact_time(chain, speed)
    solution = solve_ivp(
        rates,
        (0.0, horizon),
        np.concatenate((np.zeros(count), velocities)),
        method="DOP853",
        rtol=rtol,
        atol=rtol * np.repeat([speed * scale, speed], count),
        first_step=min(1e-3 * scale, horizon),
        dense_output=True,
        events=pressed,
    )
    if not solution.success:
        raise ChainError(f"integration of a contact failed: {solution.message}")

    def motion(time: FloatArray) -> tuple[FloatArray, FloatArray]:
        state = solution.sol(time).T
        return angles + state[:, :count], state[:, count:]

    return motion, float(solution.t[-1])


def _impact_time(chain: Chain, speed: float) -> float:
    """Return the Hertz contact time of the softest pair at an angular velocity [s]."""
    mass = np.array(chain.masses)
    reduced = mass[:-1] * mass[1:] / (mass[:-1] + mass[1:])
    pairs = zip(reduced, chain.stiffness, strict=True)
    return max(contact_time(mu, k, chain.length * speed) for mu, k in pairs)
