"""A family of random scenes: how they are drawn, run and judged."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from typing import Any, Protocol

from mujoco_impact_lab.stress.promises import Invariant, Limit, Runs


class AnyCase(Protocol):
    """A random scene of some family."""

    @property
    def seed(self) -> int:
        """What it is reproduced from."""

    def describe(self) -> str:
        """Returns the case in one line."""


def _nothing(_of: Any) -> tuple[()]:
    return ()


@dataclasses.dataclass(frozen=True)
class Family:
    """A kind of random scenes.

    Attributes:
        name: Of the family, for the command line.
        about: What is drawn, a paragraph for the report.
        methods: The ways of computing its impacts, ours first.
        case_of: Returns the case of a seed.
        evidence_of: Returns the runs of a case under a method.
        invariants: What must hold.
        limits: What excuses a case.
        story: Returns what happened in a case, in lines.
        simplifications: Returns ways of making a case simpler.
    """

    name: str
    about: str
    methods: tuple[str, ...]
    case_of: Callable[[int], AnyCase]
    evidence_of: Callable[[Any, str], Runs]
    invariants: tuple[Invariant, ...]
    limits: tuple[Limit, ...]
    story: Callable[[Any], Iterable[str]] = _nothing
    simplifications: Callable[[Any], Iterable[Callable[[Any], Any]]] = _nothing
