"""Stretches of a run between quiet samples: what an impact takes, it has given back.

A pulse that lasts longer than a step, or a soft contact, stores energy. What it may
have added is what it has given in all since nothing acted; at no time may that be
positive, for what is stored is not negative.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator

import numpy as np

from mujoco_impact_lab.stress.shapes.evidence import Evidence

AROUND = 5
"""Steps before and after a stretch in which the integrator is looked at."""


@dataclasses.dataclass(frozen=True)
class Stretch:
    """Steps between two quiet samples.

    Attributes:
        first: Number of the first step.
        last: Number of the last step.
        growth: Largest energy that the contacts have added since the first step, over
            the largest kinetic energy of the run.
        integration: What MuJoCo's integrator adds to the energy without contacts,
            unsigned, over the same: in these steps and the one after them, or in the
            worst of those `AROUND`, for a body that tumbles gains and loses by turns.
        native: Whether MuJoCo's own contacts pushed.
    """

    first: int
    last: int
    growth: float
    integration: float
    native: bool

    @property
    def steps(self) -> int:
        """How many they are."""
        return self.last - self.first + 1


def stretches(evidence: Evidence) -> Iterator[Stretch]:
    """Yields the stretches of a sound run in which a contact of any kind acted."""
    run, scale = evidence.run, evidence.kinetic
    quiet = np.flatnonzero(run.quiet)
    ends = np.unique(np.concatenate([[0], quiet, [len(run.quiet) - 1]]))
    for first, end in itertools.pairwise(ends):
        native = bool(run.pushed[first:end].any())
        gained = evidence.gained[first:end]
        # an impact without a record is seen by what it does
        if not (native or run.struck[first:end].any() or gained.any()):
            continue
        yield Stretch(
            first=int(first),
            last=int(end) - 1,
            growth=float(np.cumsum(gained).max()) / scale,
            # with the step after, whose speeds the impacts have left
            integration=max(
                float(evidence.integration[first : end + 1].sum()),
                float(
                    evidence.integration[
                        max(0, first - AROUND) : end + 1 + AROUND
                    ].max()
                ),
            )
            / scale,
            native=native,
        )
