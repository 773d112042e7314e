"""What a promise and a limit are, and the promises that every family makes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from mujoco_impact_lab.stress.methods import OURS
from mujoco_impact_lab.stress.observe import Observation


class Runs(Protocol):
    """The runs of one case under one method, by which its promises are judged."""

    @property
    def method(self) -> str:
        """Of `METHODS`."""

    @property
    def run(self) -> Observation:
        """The case itself."""

    @property
    def again(self) -> Observation:
        """The same once more."""


@dataclasses.dataclass(frozen=True)
class Invariant:
    """One promise.

    Attributes:
        name: Short, for tables.
        promise: In words.
        bound: Largest value allowed.
        reason: Why that bound.
        value: Returns how far the promise is from holding for the evidence of a case,
            a number >= 0 that the bound is for, or None where it says nothing.
        ours_only: Whether MuJoCo's own contacts do not promise it.
    """

    name: str
    promise: str
    bound: float
    reason: str
    value: Callable[[Any], float | None]
    ours_only: bool = False


@dataclasses.dataclass(frozen=True)
class Limit:
    """One documented limit: what a case outside of it is counted as.

    Attributes:
        name: Short, for tables.
        meaning: In words.
        invariants: Names of the invariants that it touches.
        holds: Whether the evidence shows a case outside of it.
        ours_only: Whether it excuses only what we do.
    """

    name: str
    meaning: str
    invariants: frozenset[str]
    holds: Callable[[Any], bool]
    ours_only: bool = True


def first_limit(limits: Sequence[Limit], evidence: Runs, invariant: str) -> str:
    """Returns the name of the first limit that a case is outside of, "" if of none."""
    for limit in limits:
        if limit.ours_only and evidence.method != OURS:
            continue
        if invariant in limit.invariants and limit.holds(evidence):
            return limit.name
    return ""


def _not_finite(evidence: Runs) -> float:
    """Counts what is not a number, and MuJoCo's warnings of a diverging state."""
    run = evidence.run
    bad = sum(int(np.sum(~np.isfinite(x))) for x in (run.qpos, run.qvel))
    return float(bad + len(run.warnings))


def _pull(evidence: Runs) -> float | None:
    """Largest pull, over the largest push."""
    impulses = [impact.impulse for impact in evidence.run.impacts]
    if not impulses:
        return None
    return max(0.0, -min(impulses)) / max(max(impulses), 1e-300)


def _other_bits(evidence: Runs) -> float:
    """1 if a second run ends in other bits."""
    return float(evidence.run.bits != evidence.again.bits)


FINITE = Invariant(
    "finite",
    "states are finite and MuJoCo warns of nothing",
    0.0,
    "exact",
    _not_finite,
)
NO_PULL = Invariant("no pull", "normal impulses are not negative", 0.0, "exact", _pull)
SAME_BITS = Invariant(
    "same bits", "a run repeated gives the same bits", 0.0, "exact", _other_bits
)
