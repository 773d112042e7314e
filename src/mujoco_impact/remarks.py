"""What a run has to say about itself beyond its numbers."""

from __future__ import annotations

import dataclasses

FAST = "fast"
"""A body closed in on another faster than its gap allows."""

PASSING = "passing"
"""Bodies went through each other."""

ENERGY = "energy"
"""Energy grew beyond what forces did."""

NO_IMPACT = "no impact"
"""Nothing touched."""

NATIVE = "native"
"""The model has no plugin: its contacts are MuJoCo's own."""

QUIET = frozenset({NO_IMPACT, NATIVE})
"""Remarks that are no fault: a run does not warn of them."""


@dataclasses.dataclass(frozen=True)
class Remark:
    """One thing that deserves attention, with the likely cause and the cure.

    Attributes:
        kind: `FAST`, `PASSING`, `ENERGY`, `NO_IMPACT` or `NATIVE`.
        text: One sentence or two.
    """

    kind: str
    text: str
