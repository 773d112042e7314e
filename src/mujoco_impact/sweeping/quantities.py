"""What a sweep can record of a case: names, units, and how each is read off."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from mujoco_impact.comparing.first_impact import FirstImpact
from mujoco_impact.comparison import OURS, MethodResult
from mujoco_impact.errors import ConfigError
from mujoco_impact.files import quoted
from mujoco_impact.text import closest

Recorded: TypeAlias = str | int | float | None
"""What stands in a cell of what was recorded; None if it is not known."""

INTEGER, NUMBER, TEXT = "integer", "number", "text"
"""Kinds of columns."""

CLOCK, MOTION, REFERENCE = "clock", "motion", "reference"
"""What a quantity is read off: a clock, the motion, its difference from the truth."""

AXES = "xyz"


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What one case came to.

    Attributes:
        numbers: The numbers that a comparison has of the method, see `compare`.
        result: What was measured of its motion.
        first: The first impact of our motion.
        bodies: Names of its bodies.
        geoms: Names of the geoms of the scene.
        scale: The largest energy of motion of ours [J].
        speed: Closing speed of the first impact [m/s].
    """

    numbers: Mapping[str, Any]
    result: MethodResult
    first: FirstImpact
    bodies: tuple[str, ...]
    geoms: frozenset[str]
    scale: float
    speed: float


@dataclasses.dataclass(frozen=True)
class Quantity:
    """Something that can be recorded.

    Attributes:
        meaning: What it is.
        read: How it is read off the outcome of a case, None for what a clock tells.
        unit: Its unit, "" if it has none.
        kind: Kind of its column.
        of: `MOTION`, `REFERENCE` or `CLOCK`.
    """

    meaning: str
    read: Callable[[Outcome], Recorded] | None
    unit: str = ""
    kind: str = NUMBER
    of: str = MOTION


def _number(name: str) -> Callable[[Outcome], Recorded]:
    """Returns what reads a number of a comparison."""

    def read(outcome: Outcome) -> Recorded:
        found: Recorded = outcome.numbers[name]
        return found

    return read


def _energy_change(outcome: Outcome) -> Recorded:
    """Returns the change of energy from first to last sample, over the scale."""
    seen = outcome.result.seen
    if seen is None or not outcome.scale:
        return None
    return float(seen.energy[-1] - seen.energy[0]) / outcome.scale


def _impulse(outcome: Outcome, pair: frozenset[str] | None = None) -> Recorded:
    """Returns the normal impulses of the first impact [N s], of a pair or of all.

    MuJoCo's contacts do not tell theirs, and a scene may not have the pair.
    """
    if outcome.result.name != OURS or not outcome.geoms.issuperset(pair or ()):
        return None
    return float(
        sum(
            one.impulse
            for one in outcome.first.meetings
            if pair is None or frozenset(one.geoms) == pair
        )
    )


QUANTITIES: Mapping[str, Quantity] = MappingProxyType(
    {
        "impact_speed": Quantity(
            "closing speed of the first impact", lambda one: one.speed, "m/s"
        ),
        "velocity_error": Quantity(
            "velocities after the first impact, RMS difference from the reference",
            _number("velocity_error"),
            "impact speed",
            of=REFERENCE,
        ),
        "angle_rms": Quantity(
            "angles of a row of pendulums, RMS difference from the reference",
            _number("angle_rms"),
            "rad",
            of=REFERENCE,
        ),
        "velocity_rms": Quantity(
            "velocities of a row of pendulums, RMS difference from the reference",
            _number("velocity_rms"),
            "rad/s",
            of=REFERENCE,
        ),
        "energy_lost": Quantity(
            "energy that impacts took", _number("energy_lost"), "energy of motion"
        ),
        "energy_change": Quantity(
            "energy at the end less that at the start",
            _energy_change,
            "energy of motion",
        ),
        "impacts": Quantity("number of impacts", _number("impacts"), kind=INTEGER),
        "deepest_overlap": Quantity(
            "deepest overlap at the ends of steps", _number("deepest_overlap"), "m"
        ),
        "passed": Quantity(
            "number of pairs that passed through each other",
            lambda one: len(one.numbers["passed"]),
            kind=INTEGER,
        ),
        "impulse": Quantity(
            "normal impulses of the first impact together, ours", _impulse, "N s"
        ),
        "velocity_after": Quantity(
            "velocity of each body after the first impact", None, "m/s"
        ),
        "run_time": Quantity("run time of a simulated second", None, "s/s", of=CLOCK),
    }
)
"""What can be recorded."""

_PARTS: Mapping[str, str] = MappingProxyType(
    {"impulse": "GEOM+GEOM", "velocity_after": "BODY"}
)
"""Quantities that can be recorded of something by name, as in `impulse.GEOM+GEOM`."""


def check_recorded(name: Any) -> None:
    """Raises ConfigError if there is no quantity of some name."""
    quantity, dot, part = name.partition(".") if isinstance(name, str) else ("",) * 3
    form = _PARTS.get(quantity)
    if quantity not in QUANTITIES or (dot and not (form and part)):
        known = [*QUANTITIES, *(f"{one}.{form}" for one, form in _PARTS.items())]
        msg = f"record: there is no {quoted(name)}{closest(str(name), known)}"
        raise ConfigError(msg)
    if quantity == "impulse" and dot and len({*part.split("+")}) != 2:
        msg = f"record: {name!r}: must be impulse.GEOM+GEOM, two geoms that meet"
        raise ConfigError(msg)


def check_parts(name: str, geoms: Sequence[str], bodies: Sequence[str]) -> None:
    """Raises ConfigError if something is recorded of what a scene does not have.

    Args:
        name: What to record.
        geoms: Names of the geoms of the scene.
        bodies: Names of its bodies that can move.
    """
    quantity, _, part = name.partition(".")
    kind, known = ("geom", geoms) if quantity == "impulse" else ("moving body", bodies)
    for one in part.split("+") if quantity == "impulse" else [part]:
        if part and one not in known:
            msg = f"record: {name!r}: the scene has no {kind} {one!r}"
            raise ConfigError(msg + closest(one, known))


def needs(record: tuple[str, ...]) -> set[str]:
    """Returns what has to be known to record some quantities."""
    return {QUANTITIES[name.partition(".")[0]].of for name in record}


def recorded(name: str, outcome: Outcome) -> dict[str, Recorded]:
    """Returns the columns of a quantity of motion and what stands in them.

    Args:
        name: What to record; `velocity_after` with the name of a body.
        outcome: What the case came to.
    """
    quantity, _, part = name.partition(".")
    if quantity == "velocity_after":
        return dict(zip(velocity_columns(part), _after(outcome, part), strict=True))
    if part:
        return {name: _impulse(outcome, frozenset(part.split("+")))}
    read = QUANTITIES[name].read
    return {name: None if read is None else read(outcome)}


def velocity_columns(body: str) -> list[str]:
    """Returns the names of the columns of the velocity of a body."""
    return [f"velocity_after.{body}.{axis}" for axis in AXES]


def _after(outcome: Outcome, body: str) -> list[Recorded]:
    """Returns the velocity of a body after the first impact [m/s], if it takes part."""
    after = outcome.result.after
    if after is None or body not in outcome.bodies:
        return [None] * len(AXES)
    velocity = after[outcome.bodies.index(body)]
    return [float(part) for part in np.asarray(velocity)]
