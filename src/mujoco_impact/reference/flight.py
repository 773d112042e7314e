"""Free pendulums in closed form, and when two of them first touch.

A pendulum a'' = -w^2 sin a keeps k^2 = sin^2(a/2) + (a' / 2w)^2. Below the top (k < 1)

    sin(a/2) = k sn(u, k^2),   cos(a/2) = dn(u, k^2),   a' = 2 w k cn(u, k^2),

u growing by w per second; over the top (k > 1) a/2 = am(u, 1/k^2) and
a' = +-2 w k dn(u, 1/k^2), u growing by +-w k per second [Abramowitz and Stegun, 16].
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from mujoco_impact.reference.chain import Chain, FloatArray

#: Overlap below which a pair counts as just touching [m]: a thousand times the
#: rounding of positions of a metre's fraction, and a force of 1e-11 N for 30 mm steel.
TOUCH = 1e-14

#: Cells per period of small swings in which contacts are looked for, and cells looked
#: at in one go. A gap changes like a few harmonics of the swing, so that it has at most
#: one minimum or maximum in a cell of 1/128 period.
CELLS_PER_PERIOD = 128
CELLS_AT_ONCE = 32


def free_flight(
    angles: FloatArray,
    velocities: FloatArray,
    frequency: FloatArray,
    elapsed: FloatArray | float,
) -> tuple[FloatArray, FloatArray]:
    """Return where free pendulums are after some time, exact to rounding.

    Args:
        angles: Angles at time 0 [rad], shape (n,).
        velocities: Angular velocities at time 0 [rad/s], shape (n,).
        frequency: Angular frequencies of small swings w [rad/s], shape (n,).
        elapsed: Times [s], shape (...), negative: back in time.

    Returns:
        Angles [rad] and velocities [rad/s], shape (..., n).
    """
    time = np.asarray(elapsed, dtype=float)[..., np.newaxis]
    turns = 2 * np.pi * np.round(angles / (2 * np.pi))
    sine = np.sin(0.5 * (angles - turns))
    cosine = velocities / (2 * frequency)
    modulus = sine**2 + cosine**2
    swing = _swing(sine, cosine, np.minimum(modulus, 1.0), frequency, time)
    if not (modulus > 1).any():
        return swing[0] + turns, swing[1]
    phase = 0.5 * (angles - turns)
    rotation = _rotate(phase, cosine, np.maximum(modulus, 1.0), frequency, time)
    over = modulus > 1
    angle = np.where(over, rotation[0], swing[0]) + turns
    return angle, np.where(over, rotation[1], swing[1])


def _swing(
    sine: FloatArray,
    cosine: FloatArray,
    modulus: FloatArray,
    frequency: FloatArray,
    time: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the motion below the top; k sn = `sine` and k cn = `cosine` at time 0."""
    from scipy.special import ellipj, ellipkinc

    k = np.sqrt(modulus)
    start = ellipkinc(np.arctan2(sine, cosine), modulus)
    sn, cn, dn, _ = ellipj(start + frequency * time, modulus)
    return 2 * np.arctan2(k * sn, dn), 2 * frequency * k * cn


def _rotate(
    phase: FloatArray,
    cosine: FloatArray,
    modulus: FloatArray,
    frequency: FloatArray,
    time: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the motion over the top; `phase` is half of the angle at time 0."""
    from scipy.special import ellipj, ellipkinc

    k = np.copysign(np.sqrt(modulus), cosine)
    start = ellipkinc(phase, 1 / modulus)
    _, _, dn, amplitude = ellipj(start + k * frequency * time, 1 / modulus)
    return 2 * amplitude, 2 * frequency * k * dn


def time_to_contact(
    chain: Chain, angles: FloatArray, velocities: FloatArray, horizon: float
) -> float | None:
    """Return when free pendulums first press on each other [s], None: not in time.

    A pair touches when its gap falls through -`TOUCH`.

    Args:
        chain: The row.
        angles: Angles at time 0 [rad], shape (n,).
        velocities: Angular velocities at time 0 [rad/s], shape (n,).
        horizon: How far to look ahead [s].
    """
    if chain.count < 2:
        return None

    def gap_and_rate(time: FloatArray | float) -> tuple[FloatArray, FloatArray]:
        angle, velocity = free_flight(angles, velocities, chain.frequency, time)
        gap, left, right = chain.contacts(angle)
        rate = left * velocity[..., :-1] + right * velocity[..., 1:]
        return gap + TOUCH, rate

    cell = 2 * np.pi / (chain.frequency.max() * CELLS_PER_PERIOD)
    start = 0.0
    while start < horizon:
        stop = min(start + CELLS_AT_ONCE * cell, horizon)
        edges = np.linspace(start, stop, CELLS_AT_ONCE + 1)
        found = _first_closing(gap_and_rate, edges)
        if found is not None:
            return found
        start = stop
    return None


def _first_closing(
    gap_and_rate: Callable[[FloatArray | float], tuple[FloatArray, FloatArray]],
    edges: FloatArray,
) -> float | None:
    """Return the first time at which a gap falls through zero, None: never.

    Args:
        gap_and_rate: Gaps [m] and their rates [m/s] at times [s].
        edges: Edges of the cells [s], rising.
    """
    gap, rate = gap_and_rate(edges)
    # A contact that has just ended is at zero and rising; anything else below is not.
    if ((gap[0] < -TOUCH) | ((gap[0] < 0) & (rate[0] <= 0))).any():
        return float(edges[0])
    lowest_between = (rate[:-1] < 0) & (rate[1:] > 0)
    suspicious = (gap[1:] < 0) | lowest_between
    for index in np.flatnonzero(suspicious.any(axis=1)):
        low, high = float(edges[index]), float(edges[index + 1])
        times = [
            _closing_in_cell(gap_and_rate, int(pair), low, high)
            for pair in np.flatnonzero(suspicious[index])
        ]
        found = [time for time in times if time is not None]
        if found:
            return min(found)
    return None


def _closing_in_cell(
    gap_and_rate: Callable[[FloatArray | float], tuple[FloatArray, FloatArray]],
    pair: int,
    low: float,
    high: float,
) -> float | None:
    """Return when the gap of one pair falls through zero in a cell, None: it does not.

    The cell is split where the gap is smallest or largest, into monotonic parts.
    """
    from scipy.optimize import brentq

    def gap(time: float) -> float:
        return float(gap_and_rate(time)[0][pair])

    def rate(time: float) -> float:
        return float(gap_and_rate(time)[1][pair])

    ends = [low, high]
    if rate(low) * rate(high) < 0:
        ends.insert(1, float(brentq(rate, low, high, xtol=1e-15)))
    for left, right in itertools.pairwise(ends):
        if gap(right) < 0 <= gap(left):
            return float(brentq(gap, left, right, xtol=1e-16, rtol=1e-15))
    return None
