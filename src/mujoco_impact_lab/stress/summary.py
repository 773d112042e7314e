"""What the outcomes of a sweep add up to."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterable, Sequence

from mujoco_impact_lab.stress.families import BALLS
from mujoco_impact_lab.stress.family import Family
from mujoco_impact_lab.stress.sweep import Outcome, Verdict

WORST = 5
"""How many seeds are named per invariant."""


@dataclasses.dataclass(frozen=True)
class Tally:
    """One invariant under one method.

    Attributes:
        method: Of `METHODS`.
        invariant: Its name.
        bound: Largest value allowed.
        judged: Cases in which it says something.
        violations: Cases in which it is broken within the documented limits.
        beyond: Cases in which it is broken, by the limit that they are outside of.
        worst: Largest value within the limits.
        worst_beyond: Largest value outside of them.
        seeds: Seeds of the worst values within the limits, worst first.
    """

    method: str
    invariant: str
    bound: float
    judged: int
    violations: int
    beyond: dict[str, int]
    worst: float
    worst_beyond: float
    seeds: tuple[int, ...]


@dataclasses.dataclass(frozen=True)
class Summary:
    """A sweep in numbers.

    Attributes:
        cases: How many.
        struck: Cases with an impact of the plugin.
        impacts: Impacts of the plugin in all.
        failures: Errors by seed.
        tallies: Per method and invariant.
        slowdown: Largest processor time of a step of ours over that of MuJoCo's usual
            step in the same scene, and the seed of that scene; None unless both ran.
    """

    cases: int
    struck: int
    impacts: int
    failures: dict[int, str]
    tallies: tuple[Tally, ...]
    slowdown: tuple[float, int] | None

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods, in their order."""
        return tuple(dict.fromkeys(tally.method for tally in self.tallies))

    def violations(self, method: str) -> int:
        """Returns the number of broken promises of a method, errors included."""
        broken = sum(t.violations for t in self.tallies if t.method == method)
        return broken + len(self.failures)

    def tally(self, method: str, invariant: str) -> Tally | None:
        """Returns one tally, None if the invariant says nothing of the method."""
        for tally in self.tallies:
            if (tally.method, tally.invariant) == (method, invariant):
                return tally
        return None


def summarise(outcomes: Sequence[Outcome], family: Family = BALLS) -> Summary:
    """Returns the numbers of a sweep over scenes of a family."""
    verdicts: dict[tuple[str, str], list[Verdict]] = {}
    for outcome in outcomes:
        for verdict in outcome.verdicts:
            key = (verdict.method, verdict.invariant)
            verdicts.setdefault(key, []).append(verdict)
    bounds = {invariant.name: invariant.bound for invariant in family.invariants}
    return Summary(
        cases=len(outcomes),
        struck=sum(outcome.impacts > 0 for outcome in outcomes),
        impacts=sum(outcome.impacts for outcome in outcomes),
        failures={o.case.seed: o.failure for o in outcomes if o.failure},
        tallies=tuple(
            _tally(method, invariant, bounds[invariant], found)
            for (method, invariant), found in verdicts.items()
        ),
        slowdown=max(
            ((o.slowdown, o.case.seed) for o in outcomes if o.slowdown is not None),
            default=None,
        ),
    )


def _tally(
    method: str, invariant: str, bound: float, verdicts: Iterable[Verdict]
) -> Tally:
    """Returns the numbers of one invariant under one method."""
    found = list(verdicts)
    inside = sorted(
        (v for v in found if not v.limit), key=lambda v: v.value, reverse=True
    )
    outside = [v for v in found if v.limit]
    return Tally(
        method=method,
        invariant=invariant,
        bound=bound,
        judged=len(found),
        violations=sum(v.is_violation for v in found),
        beyond=dict(Counter(v.limit for v in outside).most_common()),
        worst=inside[0].value if inside else 0.0,
        worst_beyond=max((v.value for v in outside), default=0.0),
        seeds=tuple(v.seed for v in inside[:WORST] if v.value > 0),
    )
