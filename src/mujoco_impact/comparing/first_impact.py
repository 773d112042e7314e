"""The first impact of a scene: who takes part, and how fast before and after.

Ours are those that follow on one another without a pause of a step. MuJoCo's contacts
last many steps, and no record tells which: an impact shows in the velocities. It is
over once no body that takes part changes its velocity by more than gravity and the like
would, for `QUIET` steps.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import mujoco
import numpy as np

from mujoco_impact.comparing.survey import LONGEST_CONTACT, Survey, rest_speed, step_of
from mujoco_impact.impact_list import Meeting, met
from mujoco_impact.trajectory import Array, Trajectory

QUIET = 3
"""Steps without a jump after which an impact is over."""

JUMP = 2e-3
"""Change of velocity in a step that is a jump, over the closing speed."""

WEIGHTS = 1.5
"""Change of velocity in a step that is none, over what gravity makes of it."""


@dataclasses.dataclass(frozen=True)
class FirstImpact:
    """The first impact of our motion.

    Attributes:
        time: When it begins [s].
        closing_speed: Speed at which the two geoms met [m/s].
        geoms: Ids of the two geoms.
        bodies: Ids of the moving bodies that take part, in the order in which they are
            struck: they, or what hangs on the same free body, are in touch.
        meetings: All the impacts that belong to it.
        before: Number of the last sample before it.
        after: Number of the first sample after it.
        alone: Whether no earlier pulse is under way, and its own are over by then.
    """

    time: float
    closing_speed: float
    geoms: tuple[int, int]
    bodies: tuple[int, ...]
    meetings: tuple[Meeting, ...]
    before: int
    after: int
    alone: bool


def find_first_impact(
    model: mujoco.MjModel, motion: Trajectory, geom_ids: dict[str, int]
) -> FirstImpact | None:
    """Returns the first impact of our motion that is faster than rest, None if none is.

    Args:
        model: The scene without the plugin.
        motion: Our motion.
        geom_ids: Ids of the geoms by the names that impacts call them.
    """
    found = met(motion.impacts, motion.timestep)
    rest = rest_speed(model, motion)
    first = next((one for one in found if one.closing_speed > rest), None)
    if first is None:
        return None
    step = float(motion.time[1] - motion.time[0])
    group = _group(model, found, first, geom_ids, step)
    end = max(meeting.time + meeting.duration for meeting in group)
    before = step_of(motion.time, min(meeting.time for meeting in group))
    after = max(before + 1, int(np.searchsorted(motion.time, end)))
    struck = [body for one in group for body in _bodies(model, one, geom_ids)]
    bodies = tuple(dict.fromkeys(struck))
    pressed = any(
        one.time < first.time < one.time + one.duration
        and set(_bodies(model, one, geom_ids)) & set(bodies)
        for one in found
        if one not in group
    )
    one, other = (geom_ids[name] for name in first.geoms)
    return FirstImpact(
        time=first.time,
        closing_speed=first.closing_speed,
        geoms=(one, other),
        bodies=bodies,
        meetings=tuple(group),
        before=before,
        after=min(after, len(motion.time) - 1),
        alone=not pressed and after < len(motion.time),
    )


def window_of(
    model: mujoco.MjModel, first: FirstImpact, motion: Trajectory, seen: Survey
) -> tuple[int, int] | None:
    """Returns the samples before and after the first impact as another motion has it.

    Args:
        model: The scene without the plugin.
        first: The first impact of our motion.
        motion: The other motion.
        seen: What was seen of it.

    Returns:
        None if the two geoms do not meet near that time.
    """
    pair = tuple(sorted(first.geoms))
    begun = [
        one.first - 1
        for one in seen.touches
        if one.pair == pair and one.first >= max(1, first.before - QUIET)
    ]
    if not begun:
        return None
    before = begun[0]
    return before, _end(model, motion, seen, before, first.bodies, first.closing_speed)


def _group(
    model: mujoco.MjModel,
    found: Sequence[Meeting],
    first: Meeting,
    geom_ids: dict[str, int],
    step: float,
) -> list[Meeting]:
    """Returns the impacts that follow on one another without a pause of a step.

    They share bodies, or bodies that hang on the same free one.
    """
    trees = {
        id(one): {int(model.body_treeid[b]) for b in _bodies(model, one, geom_ids)}
        for one in found
    }
    group, joined = [first], trees[id(first)]
    begin, end = first.time, first.time + first.duration
    while True:
        more = [
            one
            for one in found
            if one not in group
            and begin <= one.time + step / 2
            and one.time <= end + step
            and trees[id(one)] & joined
        ]
        if not more:
            return sorted(group, key=lambda one: one.time)
        group += more
        joined = joined.union(*(trees[id(one)] for one in more))
        end = max(end, *(one.time + one.duration for one in more))


def _bodies(
    model: mujoco.MjModel, meeting: Meeting, geom_ids: dict[str, int]
) -> tuple[int, ...]:
    """Returns the bodies of an impact that can move."""
    bodies = [int(model.geom_bodyid[geom_ids[name]]) for name in meeting.geoms]
    return tuple(body for body in bodies if model.body_weldid[body] != 0)


def _end(
    model: mujoco.MjModel,
    motion: Trajectory,
    seen: Survey,
    before: int,
    bodies: tuple[int, ...],
    speed: float,
) -> int:
    """Returns the first sample at which none of the bodies is being struck any more."""
    step = float(motion.time[1] - motion.time[0])
    last = min(len(motion.time) - 1, before + max(QUIET, round(LONGEST_CONTACT / step)))
    change = np.diff(seen.velocities[: last + 1, bodies], axis=0)
    usual = change[before - 1] if before else np.zeros_like(change[0])
    size = np.linalg.norm(change[before:] - usual, axis=2).max(axis=1)
    gravity = float(np.linalg.norm(model.opt.gravity))
    jumps = size > WEIGHTS * gravity * step + JUMP * speed
    quiet = 0
    for number, jumping in enumerate(jumps[1:], start=1):
        quiet = 0 if jumping else quiet + 1
        if quiet == QUIET:
            return before + number - QUIET + 1
    return last


def velocities_at(
    motion: Trajectory, seen: Survey, sample: int, bodies: tuple[int, ...], free: Array
) -> Array:
    """Returns the velocities of bodies at the time of a sample [m/s], shape (n, 3).

    Semi-implicit steps leave velocities half a step behind the positions.

    Args:
        motion: The motion.
        seen: What was seen of it.
        sample: Number of the sample.
        bodies: Ids of the n bodies.
        free: Their acceleration without impacts [m/s²], shape (n, 3).
    """
    from mujoco_impact.comparing.survey import HALF_STEP_INTEGRATORS

    half = 0.5 * motion.timestep if motion.integrator in HALF_STEP_INTEGRATORS else 0.0
    found: Array = seen.velocities[sample, bodies] + half * free
    return found
