"""The impacts of a run as a person wants to read them.

Points of two geoms that begin in the same step are one impact, such as the corners of a
box that lands on a face. A body that bounces out is one line, however long that takes.
"""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Iterable, Sequence

from mujoco_impact.impact import Impact

SMALL = 0.1
"""Impacts below this part of the fastest closing speed, and of the largest impulse, are
small. A comparison counts by the speed alone: MuJoCo's contacts tell no impulse."""

FEWEST = 3
"""So many small impacts of the same two geoms in a row are told in one line."""

QUIET = 3.0
"""A row of small impacts has ended if nothing followed for so many of its intervals."""


@dataclasses.dataclass(frozen=True)
class Meeting:
    """An impact of two geoms, all its points together.

    Attributes:
        time: Onset of the first point [s].
        geoms: Names of the two geoms.
        closing_speed: The largest of its points [m/s].
        impulse: Sum of the normal impulses [N s].
        peak: Largest force of a point [N].
        duration: The longest of its points [s].
        points: Number of points.
    """

    time: float
    geoms: tuple[str, str]
    closing_speed: float
    impulse: float
    peak: float
    duration: float
    points: int


@dataclasses.dataclass(frozen=True)
class Bounces:
    """Small impacts of the same two geoms, one after the other.

    Attributes:
        geoms: Names of the two geoms.
        count: How many.
        begin: Time of the first [s].
        end: Time of the last [s].
        fastest: Largest closing speed [m/s].
        over: Whether the row ended before the run did.
        slowed: Whether they came to less than half of that speed, and met no more.
    """

    geoms: tuple[str, str]
    count: int
    begin: float
    end: float
    fastest: float
    over: bool
    slowed: bool

    def __str__(self) -> str:
        """Returns one line about it."""
        what = f"{' - '.join(self.geoms)}: {self.count} small impacts"
        last = "comes to rest" if self.slowed else "the last"
        end = f"{last} at {self.end:.3f} s" if self.over else "on to the end"
        return f"{what} (up to {self.fastest:.2g} m/s) from {self.begin:.3f} s, {end}"


def listed(
    impacts: Sequence[Impact], *, timestep: float, end: float
) -> tuple[list[Meeting], list[Bounces]]:
    """Returns the impacts that matter, in order of time, and rows of small ones.

    Args:
        impacts: The impacts of a run, in order of time.
        timestep: Of the simulation [s].
        end: Time at which the run ends [s].
    """
    meetings = met(impacts, timestep)
    if not meetings:
        return [], []
    speed = small_speed(impacts)
    impulse = SMALL * max(one.impulse for one in meetings)
    pairs: dict[frozenset[str], list[Meeting]] = defaultdict(list)
    for one in meetings:
        pairs[frozenset(one.geoms)].append(one)
    large, rows = [], []
    for of_pair in pairs.values():
        for row in _rows(of_pair, speed, impulse):
            if len(row) < FEWEST:
                large += row
            else:
                rows.append(_bounces(row, end, final=row[-1] is of_pair[-1]))
    large.sort(key=lambda one: one.time)
    rows.sort(key=lambda one: one.begin)
    return large, rows


def small_speed(impacts: Iterable[Impact]) -> float:
    """Returns the closing speed below which an impact of a run is small [m/s]."""
    return SMALL * max((one.closing_speed for one in impacts), default=0.0)


def met(impacts: Iterable[Impact], timestep: float) -> list[Meeting]:
    """Returns impacts with the points of one step and one pair put together."""
    found: dict[tuple[frozenset[str], int], list[Impact]] = {}
    latest: dict[frozenset[str], tuple[float, int]] = {}
    for number, impact in enumerate(impacts):
        pair = frozenset(impact.geoms)
        begin, group = latest.get(pair, (-1.0, -1))
        if group < 0 or impact.time - begin >= timestep / 2:
            begin, group = impact.time, number
            latest[pair] = (begin, group)
        found.setdefault((pair, group), []).append(impact)
    return [
        Meeting(
            time=points[0].time,
            geoms=points[0].geoms,
            closing_speed=max(one.closing_speed for one in points),
            impulse=sum(one.impulse for one in points),
            peak=max(one.peak for one in points),
            duration=max(one.duration for one in points),
            points=len(points),
        )
        for points in found.values()
    ]


def _rows(
    meetings: Sequence[Meeting], speed: float, impulse: float
) -> list[list[Meeting]]:
    """Returns the meetings of a pair: large ones alone, small ones in rows."""
    rows: list[list[Meeting]] = []
    small_before = False
    for one in meetings:
        small = one.closing_speed < speed and one.impulse < impulse
        if small and small_before:
            rows[-1].append(one)
        else:
            rows.append([one])
        small_before = small
    return rows


def _bounces(row: Sequence[Meeting], end: float, *, final: bool) -> Bounces:
    """Returns a row of small impacts as one; `final`: the two met no more."""
    last = row[-1].time - row[-2].time
    fastest = max(one.closing_speed for one in row)
    return Bounces(
        geoms=row[0].geoms,
        count=len(row),
        begin=row[0].time,
        end=row[-1].time,
        fastest=fastest,
        over=not final or end - row[-1].time > QUIET * last,
        slowed=final and row[-1].closing_speed < fastest / 2,
    )
