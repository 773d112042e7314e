"""Many cases under several methods: verdicts, and what they add up to."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from typing import Any

import numpy as np

from mujoco_impact.errors import ImpactError
from mujoco_impact.executors import in_order
from mujoco_impact_lab.stress.families import BALLS, FAMILIES
from mujoco_impact_lab.stress.family import AnyCase, Family
from mujoco_impact_lab.stress.methods import DEFAULTS, OURS
from mujoco_impact_lab.stress.promises import Runs, first_limit


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
        slowdown: Processor time of our slowest step over that of MuJoCo's usual one in
            the same scene; None unless both ran. A figure, not a verdict.
    """

    case: AnyCase
    verdicts: tuple[Verdict, ...]
    impacts: int
    failure: str = ""
    slowdown: float | None = dataclasses.field(default=None, compare=False)


def judge(
    case: AnyCase, methods: Sequence[str] | None = None, *, family: Family = BALLS
) -> Outcome:
    """Runs a case under each method and judges every invariant.

    Args:
        case: Of the family.
        methods: Of those of the family; None for all of them.
        family: The kind of the scene.
    """
    verdicts: list[Verdict] = []
    seen: dict[str, Runs] = {}
    failure = ""
    try:
        for method in family.methods if methods is None else methods:
            seen[method] = family.evidence_of(case, method)
            verdicts.extend(_verdicts(case.seed, seen[method], family))
    except (ImpactError, ValueError) as error:
        failure = " ".join(str(error).split())
        return Outcome(case, tuple(verdicts), 0, failure)
    ours = seen[OURS].run if OURS in seen else None
    return Outcome(
        case,
        tuple(verdicts),
        impacts=len(ours.impacts) + ours.missed if ours else 0,
        slowdown=_slowdown(seen),
    )


def sweep(
    seeds: Iterable[int],
    *,
    family: Family = BALLS,
    methods: Sequence[str] | None = None,
    executor: Executor | None = None,
    processes: int | None = None,
    progress: Callable[[Outcome], None] | None = None,
) -> list[Outcome]:
    """Judges the cases of many seeds; the result does not depend on where.

    Args:
        seeds: One per case.
        family: The kind of the scenes.
        methods: Of those of the family; None for all of them.
        executor: Where to run the cases, see `in_order`: in processes, for a case has
            MuJoCo's callbacks to itself.
        processes: How many to run at a time on this machine, instead of an executor.
        progress: Called with each outcome, in the order of the seeds.
    """
    chosen = family.methods if methods is None else tuple(methods)
    tasks = [(seed, family.name, chosen) for seed in seeds]
    outcomes = []
    for outcome in in_order(_judge_seed, tasks, executor=executor, processes=processes):
        outcomes.append(outcome)
        if progress is not None:
            progress(outcome)
    return outcomes


def digest(outcomes: Iterable[Outcome]) -> str:
    """Returns a hash of all bits of outcomes, but for the time they took."""

    def plain(value: Any) -> Any:
        return value.item()

    dicts = [{**dataclasses.asdict(outcome), "slowdown": None} for outcome in outcomes]
    text = json.dumps(dicts, sort_keys=True, default=plain)
    return hashlib.sha256(text.encode()).hexdigest()


def _judge_seed(task: tuple[int, str, tuple[str, ...]]) -> Outcome:
    """Judges the case of a seed, maybe in a process of its own."""
    seed, name, methods = task
    family = FAMILIES[name]
    return judge(family.case_of(seed), methods, family=family)


def _verdicts(seed: int, evidence: Runs, family: Family) -> Iterator[Verdict]:
    """Yields the verdict of each invariant that says something about a case."""
    for invariant in family.invariants:
        if invariant.ours_only and evidence.method != OURS:
            continue
        value = invariant.value(evidence)
        if value is None:
            continue
        holds = value <= invariant.bound
        limit = "" if holds else first_limit(family.limits, evidence, invariant.name)
        yield Verdict(
            seed=seed,
            method=evidence.method,
            invariant=invariant.name,
            value=value,
            holds=holds,
            limit=limit,
        )


def _slowdown(seen: dict[str, Runs]) -> float | None:
    """Returns the time of our slowest step over that of MuJoCo's median one."""
    if OURS not in seen or DEFAULTS not in seen:
        return None
    # the faster of two runs: an interrupt seldom strikes twice
    ours, usual = (
        np.minimum(seen[method].run.seconds, seen[method].again.seconds)
        for method in (OURS, DEFAULTS)
    )
    return float(ours.max() / np.median(usual))
