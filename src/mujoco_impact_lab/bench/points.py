"""A point of the benchmark, and the front of the best ones."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence


@dataclasses.dataclass(frozen=True)
class Point:
    """What one method with one setting made of one scene; nan where not known.

    Attributes:
        scene: Name of the scene.
        method: Name of the method.
        setting: What was set.
        integrator: Integrator.
        timestep: Timestep [s]; nan if it adapts.
        cost: Run time over that of MuJoCo's defaults on the same scene (2 ms, Euler),
            both timed in turn: median of the ratios.
        run_time: Wall-clock time of a simulated second [s], median.
        velocity_error: Velocities after the first impact: RMS over the balls, in
            fractions of the impact speed.
        angle_rms: Angles: RMS over balls and time [rad].
        energy_drift: Change of energy over the run, in fractions.
        comparable: Whether the cost is that of a simulator.
        failure: Why there are no numbers, else empty.
    """

    scene: str
    method: str
    setting: str
    integrator: str
    timestep: float = math.nan
    cost: float = math.nan
    run_time: float = math.nan
    velocity_error: float = math.nan
    angle_rms: float = math.nan
    energy_drift: float = math.nan
    comparable: bool = True
    failure: str = ""


def setting_of(point: Point) -> str:
    """Returns timestep, integrator and setting in a few words."""
    parts = [] if math.isnan(point.timestep) else [f"{point.timestep * 1e3:g} ms"]
    parts.append(point.integrator)
    if point.setting != "defaults":
        parts.append(point.setting)
    return ", ".join(part for part in parts if part)


def front(pairs: Sequence[tuple[float, float]]) -> list[int]:
    """Returns which pairs (cost, error) no other pair beats, by rising cost.

    A pair beats another one if it is nowhere larger and somewhere smaller. Pairs
    that hold nan are never on the front.

    Args:
        pairs: Costs and errors.
    """
    known = [i for i, pair in enumerate(pairs) if not any(map(math.isnan, pair))]
    best, chosen = math.inf, list[int]()
    for index in sorted(known, key=lambda i: pairs[i]):
        error = pairs[index][1]
        if error < best:
            best = error
            chosen.append(index)
        elif chosen and pairs[index] == pairs[chosen[-1]]:
            chosen.append(index)
    return chosen


def front_of(points: Sequence[Point], error: str) -> list[Point]:
    """Returns the simulators' points on the front of cost and one of the errors.

    Args:
        points: Points of one scene.
        error: Name of the error, such as "velocity_error".
    """
    rivals = [point for point in points if point.comparable]
    pairs = [(point.cost, getattr(point, error)) for point in rivals]
    return [rivals[index] for index in front(pairs)]
