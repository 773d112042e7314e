"""Many cases under several methods: verdicts, and what they add up to."""

from __future__ import annotations

import dataclasses
import multiprocessing
from collections.abc import Callable, Iterable, Iterator, Sequence

from mujoco_impact.errors import ImpactError
from mujoco_impact.stress.case import Case
from mujoco_impact.stress.draw import case_of
from mujoco_impact.stress.evidence import Evidence
from mujoco_impact.stress.invariants import INVARIANTS
from mujoco_impact.stress.limits import limit_of
from mujoco_impact.stress.methods import METHODS, OURS

SYMMETRIES = ("permutation", "mirror")
"""Judged for us only: MuJoCo's solver stops at a tolerance, which depends on order."""


@dataclasses.dataclass(frozen=True)
class Verdict:
    """One invariant of one case.

    Attributes:
        seed: Of the case.
        method: Of `METHODS`.
        invariant: Its name.
        value: How far it is from holding; bound and reason are with the invariant.
        holds: Whether the value is within the bound.
        limit: The documented limit that excuses it, "" if none does or it holds.
    """

    seed: int
    method: str
    invariant: str
    value: float
    holds: bool
    limit: str

    @property
    def is_violation(self) -> bool:
        """Whether it breaks a promise."""
        return not self.holds and not self.limit


@dataclasses.dataclass(frozen=True)
class Outcome:
    """All verdicts of one case.

    Attributes:
        case: The case.
        verdicts: One per invariant that says something, and method.
        impacts: Impacts of the plugin.
        failure: The error that stopped the case, "" if none.
    """

    case: Case
    verdicts: tuple[Verdict, ...]
    impacts: int
    failure: str = ""


def judge(case: Case, methods: Sequence[str] = METHODS) -> Outcome:
    """Runs a case under each method and judges every invariant."""
    verdicts: list[Verdict] = []
    impacts = 0
    try:
        for method in methods:
            evidence = Evidence(case, method)
            verdicts.extend(_verdicts(evidence))
            if method == OURS:
                impacts = len(evidence.run.impacts) + evidence.run.missed
    except (ImpactError, ValueError) as error:
        return Outcome(case, tuple(verdicts), impacts, " ".join(str(error).split()))
    return Outcome(case, tuple(verdicts), impacts)


def sweep(
    seeds: Iterable[int],
    *,
    methods: Sequence[str] = METHODS,
    processes: int = 1,
    progress: Callable[[Outcome], None] | None = None,
) -> list[Outcome]:
    """Judges the cases of many seeds; the result does not depend on `processes`.

    Args:
        seeds: One per case.
        methods: Of `METHODS`.
        processes: How many cases to run at a time.
        progress: Called with each outcome, in the order of the seeds.
    """
    outcomes = []
    for outcome in _outcomes(list(seeds), tuple(methods), processes):
        outcomes.append(outcome)
        if progress is not None:
            progress(outcome)
    return outcomes


def _outcomes(
    seeds: list[int], methods: tuple[str, ...], processes: int
) -> Iterator[Outcome]:
    """Yields the outcomes in the order of the seeds."""
    if processes == 1:
        yield from (judge(case_of(seed), methods) for seed in seeds)
        return
    # a fresh interpreter: a fork would share MuJoCo's threads and handlers
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap(_judge_seed, [(seed, methods) for seed in seeds], 8)


def _judge_seed(task: tuple[int, tuple[str, ...]]) -> Outcome:
    """Judges the case of a seed in a process of its own."""
    seed, methods = task
    return judge(case_of(seed), methods)


def _verdicts(evidence: Evidence) -> Iterator[Verdict]:
    """Yields the verdict of each invariant that says something about a case."""
    for invariant in INVARIANTS:
        if evidence.method != OURS and invariant.name in SYMMETRIES:
            continue
        value = invariant.value(evidence)
        if value is None:
            continue
        holds = value <= invariant.bound
        yield Verdict(
            seed=evidence.case.seed,
            method=evidence.method,
            invariant=invariant.name,
            value=value,
            holds=holds,
            limit="" if holds else limit_of(evidence, invariant.name),
        )
