"""What one impact costs, the law alone: a row of touching balls, no engine around it.

Beside the law runs a plain loop over the same equations of motion, with the longest
step that keeps the error allowed (`plugin/bench/impact_timing.cc`). All of them are
timed in turn, several times; medians count.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

import cradle_models
from mujoco_impact.errors import SimulationError
from mujoco_impact.reference import Chain, contact_time, first_impact
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.library import load_library
from mujoco_impact_lab.bench.truths import rms

BALLS = (3, 5, 10)
TOLERANCES = (1e-2, 4e-3, 1e-3, 1e-4, 1e-5)
"""Errors that the law may make per step; the last one is that of the plugin."""

ALLOWED_ERROR = 3e-4
"""Velocity error that the loop may have [v0]."""

WAVE_BALLS = (100, 200, 400, 800)
"""Rows that an impact travels through."""

SPEED = 0.5
"""Impact speed [m/s]."""

COARSEST, FINER, FINEST = 8.0, 2**0.25, 2000.0
"""Steps of the loop per contact time: the first tried, the next, the last."""

SETTLED = 4
"""So many finer steps must keep the error, too: one may do so by accident."""

SHORTEST_TIMING = 1e-3
"""Solves are repeated until they take so long [s]: a clock tick is nothing then."""

MOST_LOOP_STEPS = 1_000_000

MICROSECOND = 1e-6


@dataclasses.dataclass(frozen=True)
class ImpactTimes:
    """The impact of one ball on a row, solved by the law and by the loop.

    Attributes:
        balls: Number of balls.
        tolerance: Error that the law may make per step.
        steps: Steps of the law.
        error: Velocities that the law leaves: RMS over the balls [v0].
        microseconds: Time that the law takes, median.
        fastest: The same, least.
        loop_steps: Steps of the loop.
        loop_error: Velocities that the loop leaves: RMS over the balls [v0].
        loop_microseconds: Time that the loop takes, median.
        ratio: Time of the law over that of the loop, median.
    """

    balls: int
    tolerance: float
    steps: int
    error: float
    microseconds: float
    fastest: float
    loop_steps: int
    loop_error: float
    loop_microseconds: float
    ratio: float


@dataclasses.dataclass(frozen=True)
class WaveTimes:
    """An impact that travels through a long row.

    Attributes:
        balls: Number of balls.
        steps: Steps of the law.
        microseconds: Time that the law takes, median.
        per_ball: The same for each ball.
        relative: Time per ball over that in the shortest of the rows, median.
    """

    balls: int
    steps: int
    microseconds: float
    per_ball: float
    relative: float


@dataclasses.dataclass(frozen=True)
class Solved:
    """One way to solve an impact, and what came of it.

    Attributes:
        time: Solves it again; returns the seconds that it takes.
        steps: Number of steps.
        velocities: Velocities that it leaves [v0], shape (n,).
    """

    time: Callable[[], float]
    steps: int
    velocities: Array


def impact_times(
    *,
    balls: Sequence[int] = BALLS,
    tolerances: Sequence[float] = TOLERANCES,
    rounds: int = 25,
    progress: Callable[[str], None] | None = None,
) -> tuple[ImpactTimes, ...]:
    """Times the law alone beside the loop, for short rows and several tolerances.

    Args:
        balls: Numbers of balls.
        tolerances: Errors that the law may make per step.
        rounds: Timings of each, in turn.
        progress: Called with each row as it begins.
    """
    report = progress or (lambda _: None)
    results = list[ImpactTimes]()
    for count in balls:
        report(f"the law alone: {count} balls")
        truth = _truth(count)
        loop = _coarsest_loop(count, truth)
        laws = [_law(count, tolerance) for tolerance in tolerances]
        *times, loop_times = _in_turn([*laws, loop], rounds)
        for tolerance, law, mine in zip(tolerances, laws, times, strict=True):
            row = ImpactTimes(
                balls=count,
                tolerance=tolerance,
                steps=law.steps,
                error=rms(law.velocities - truth),
                microseconds=float(np.median(mine)),
                fastest=float(mine.min()),
                loop_steps=loop.steps,
                loop_error=rms(loop.velocities - truth),
                loop_microseconds=float(np.median(loop_times)),
                ratio=float(np.median(mine / loop_times)),
            )
            results.append(row)
    return tuple(results)


def wave_times(
    *,
    balls: Sequence[int] = WAVE_BALLS,
    rounds: int = 15,
    progress: Callable[[str], None] | None = None,
) -> tuple[WaveTimes, ...]:
    """Times the law alone on long rows, with the tolerance of the plugin.

    Args:
        balls: Numbers of balls.
        rounds: Timings of each, in turn.
        progress: Called once, as it begins.
    """
    if progress is not None:
        progress("the law alone: an impact travels through long rows")
    laws = [_law(count, TOLERANCES[-1]) for count in balls]
    times = _in_turn(laws, rounds)
    shortest = times[0] / balls[0]
    return tuple(
        WaveTimes(
            balls=count,
            steps=law.steps,
            microseconds=float(np.median(mine)),
            per_ball=float(np.median(mine / count)),
            relative=float(np.median(mine / count / shortest)),
        )
        for count, law, mine in zip(balls, laws, times, strict=True)
    )


def _truth(count: int) -> Array:
    """Returns the velocities of the reference [v0]."""
    chain = _chain(count)
    return first_impact(chain.masses, chain.radii).velocities


def _chain(count: int) -> Chain:
    return Chain.of(cradle_models.balls("A" * count))


def _law(count: int, tolerance: float) -> Solved:
    """Returns the impact as the law solves it."""
    return _solved(load_library().impact_timing_law, count, tolerance)


def _coarsest_loop(count: int, truth: Array) -> Solved:
    """Returns the loop with the longest step that keeps the error allowed."""
    chain = _chain(count)
    lasts = contact_time(chain.masses[0] / 2, chain.stiffness[0], SPEED)
    kept = list[Solved]()
    per_contact_time = COARSEST
    while len(kept) <= SETTLED:
        if per_contact_time > FINEST:
            msg = f"the loop over {count} balls does not reach {ALLOWED_ERROR} v0"
            raise SimulationError(msg, time=0.0)
        solve = load_library().impact_timing_loop
        loop = _solved(solve, count, lasts / per_contact_time, MOST_LOOP_STEPS)
        good = rms(loop.velocities - truth) <= ALLOWED_ERROR
        kept = [*kept, loop] if good else []
        per_contact_time *= FINER
    return kept[0]


def _solved(solve: Callable[..., int], count: int, *settings: float) -> Solved:
    """Returns what one of the functions of the library makes of an impact."""
    chain = _chain(count)
    velocities, seconds = np.zeros(count), np.zeros(1)
    mass, stiffness = float(chain.masses[0]), float(chain.stiffness[0])

    def run(repeats: int) -> int:
        return solve(
            count, mass, stiffness, SPEED, *settings, repeats, velocities, seconds
        )

    def time(repeats: int) -> float:
        run(repeats)
        return float(seconds[0])

    steps = run(1)
    if steps <= 0:
        msg = f"the impact of {count} balls did not end after {-steps} steps"
        raise SimulationError(msg, time=0.0)
    left = velocities / SPEED
    repeats = max(1, math.ceil(SHORTEST_TIMING / time(1)))
    return Solved(partial(time, repeats), steps, left)


def _in_turn(solved: Sequence[Solved], rounds: int) -> list[Array]:
    """Returns times [us] of each, shape (rounds,): all of them, round by round."""
    times = [[one.time() for one in solved] for _ in range(rounds)]
    return list(np.array(times).T / MICROSECOND)
