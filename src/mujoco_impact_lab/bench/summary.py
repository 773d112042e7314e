"""What the points of a scene say: how much more accurate, and is anything better.

Everything here follows from the points, and so from a `results.csv`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS, families
from mujoco_impact_lab.bench.points import Point, front_of, setting_of

BUDGET = 1.2
"""What counts as the run time of MuJoCo's defaults: ours may cost so much."""

ERRORS = ("velocity_error", "angle_rms")
"""The errors that are summed up."""


@dataclasses.dataclass(frozen=True)
class Summary:
    """One error in one scene; nan and empty where there is nothing to compare.

    Attributes:
        scene: Name of the scene.
        error: Name of the error.
        ours: Our smallest error at the run time of MuJoCo's defaults; if we have
            nothing that cheap, that of the cheapest.
        setting: Timestep and integrator of it.
        cost: Run time of it, over that of MuJoCo's defaults.
        default: Error of MuJoCo's defaults.
        mujoco: Smallest error of any MuJoCo setting that costs no more.
        mujoco_setting: Method and setting of it.
        advantage: Error of that setting over ours.
        engine: Smallest error of any other engine, whatever it costs.
        engine_name: The engine.
        engine_cost: Its run time, over that of MuJoCo's defaults.
        points: Number of our points.
        beaten: Those that something is both faster and more accurate than, and what.
        front_beaten: How many of them are on the front of our own points.
    """

    scene: str
    error: str
    ours: float
    setting: str
    cost: float
    default: float
    mujoco: float
    mujoco_setting: str
    advantage: float
    engine: float
    engine_name: str
    engine_cost: float
    points: int
    beaten: tuple[str, ...]
    front_beaten: int


def summarize(points: Sequence[Point]) -> tuple[Summary, ...]:
    """Sums up every scene that has points of ours, in the order of the points.

    Args:
        points: Points of any scenes.
    """
    scenes = dict.fromkeys(point.scene for point in points if point.method == OURS)
    summaries = list[Summary]()
    for scene in scenes:
        for error in ERRORS:
            found = [
                point
                for point in points
                if point.scene == scene
                and point.comparable
                and math.isfinite(point.cost)
                and math.isfinite(getattr(point, error))
            ]
            if any(point.method == OURS for point in found):
                summaries.append(_summary(scene, error, found))
    return tuple(summaries)


def _summary(scene: str, error: str, points: Sequence[Point]) -> Summary:
    """Returns the summary of one error; every point has it."""
    mujoco = {family.name for family in families()} - {OURS}
    ours = [point for point in points if point.method == OURS]
    best = _best(ours, error, max(BUDGET, min(point.cost for point in ours)))
    allowed = max(1.0, _value(best, "cost"))
    rival = _best([p for p in points if p.method in mujoco], error, allowed)
    others = [p for p in points if p.method not in mujoco and p.method != OURS]
    engine = _best(others, error, math.inf)
    plain = [p for p in points if p.method == DEFAULT and p.timestep == 2e-3]
    beaten = _beaten(ours, points, error)
    own_front = front_of(ours, error)
    return Summary(
        scene=scene,
        error=error,
        ours=_value(best, error),
        setting=_name(best),
        cost=_value(best, "cost"),
        default=_value(plain[0] if plain else None, error),
        mujoco=_value(rival, error),
        mujoco_setting=_name(rival),
        advantage=_ratio(_value(rival, error), _value(best, error)),
        engine=_value(engine, error),
        engine_name="" if engine is None else engine.method,
        engine_cost=_value(engine, "cost"),
        points=len(ours),
        beaten=tuple(f"{_name(one)} by {_name(by)}" for one, by in beaten),
        front_beaten=sum(one in own_front for one, _ in beaten),
    )


def _best(points: Sequence[Point], error: str, most: float) -> Point | None:
    """Returns the most accurate point that costs no more than `most`."""
    affordable = [point for point in points if point.cost <= most]
    return min(affordable, key=lambda point: getattr(point, error), default=None)


def _beaten(
    ours: Sequence[Point], points: Sequence[Point], error: str
) -> list[tuple[Point, Point]]:
    """Returns our points that are beaten, each with the most accurate one that does."""
    pairs = list[tuple[Point, Point]]()
    for one in ours:
        better = [
            rival
            for rival in points
            if rival.method != OURS
            and rival.cost < one.cost
            and getattr(rival, error) < getattr(one, error)
        ]
        by = _best(better, error, math.inf)
        if by is not None:
            pairs.append((one, by))
    return pairs


def _ratio(rival: float, ours: float) -> float:
    """Returns the quotient, infinite where we make no error at all."""
    return rival / ours if ours else math.inf


def _value(point: Point | None, name: str) -> float:
    return math.nan if point is None else float(getattr(point, name))


def _name(point: Point | None) -> str:
    return "" if point is None else f"{point.method}, {setting_of(point)}"
