"""All the runs of one case that its invariants are judged by."""

from __future__ import annotations

import dataclasses
from functools import cached_property

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact_lab.stress.case import Case
from mujoco_impact_lab.stress.layouts import Balls, balls_of
from mujoco_impact_lab.stress.methods import OURS, model_of
from mujoco_impact_lab.stress.record import Record, record, run_model
from mujoco_impact_lab.stress.scene import mjcf

NUDGE = 1e-6
"""Change of the start that shows how much a scene makes of small errors: that of the
impact law per step."""


FINE = (1e-7, 1e-8)
"""Tolerances of the impact law where its error is not to count; the difference between
the two shows what a scene makes of it."""


@dataclasses.dataclass(frozen=True, eq=False)
class Evidence:
    """Runs of one case under one method; each is made when it is first asked for.

    Attributes:
        case: The case.
        method: Of `METHODS`.
        tolerance: Of our impact law; None for the default.
    """

    case: Case
    method: str = OURS
    tolerance: float | None = None

    @cached_property
    def fine(self) -> tuple[Evidence, Evidence]:
        """The same with hardly any error of the law, and with ten times less."""
        coarse, fine = (Evidence(self.case, self.method, x) for x in FINE)
        return coarse, fine

    @cached_property
    def balls(self) -> Balls:
        """The balls at the start."""
        return balls_of(self.case)

    @cached_property
    def _pair(self) -> tuple[Record, Record]:
        """The case, and the same once more with data of its own."""
        model = self._model()
        first, second = (run_model(model, self.case, self.balls) for _ in range(2))
        return first, second

    @property
    def run(self) -> Record:
        """The case itself."""
        return self._pair[0]

    @property
    def again(self) -> Record:
        """The same once more."""
        return self._pair[1]

    @cached_property
    def order(self) -> npt.NDArray[np.int64]:
        """Another order of the bodies; tied joints keep the ends where they are."""
        random = np.random.default_rng((self.case.seed, 2))
        order = random.permutation(self.case.count)
        if self.case.features:
            order = np.arange(self.case.count)
            order[1:-1] = random.permutation(order[1:-1])
        return order

    @cached_property
    def permuted(self) -> Record:
        """The case with its bodies in another order."""
        return self._record(self.balls.reordered(self.order))

    @cached_property
    def mirrored(self) -> Record:
        """The mirror image of the case."""
        return self._record(self.balls.mirrored())

    @cached_property
    def nudged(self) -> Record:
        """The case with all speeds changed by parts of 1e-6."""
        random = np.random.default_rng((self.case.seed, 3))
        factor = 1 + NUDGE * random.uniform(-1, 1, size=(self.case.count, 1))
        velocity = self.balls.velocity * factor
        balls = dataclasses.replace(self.balls, velocity=velocity)
        return self._record(balls)

    @cached_property
    def solved(self) -> Record:
        """The case with MuJoCo's solver going on to rounding."""
        model = self._model()
        model.opt.tolerance = 0
        return run_model(model, self.case, self.balls)

    @cached_property
    def apart(self) -> Record:
        """The case without contacts."""
        return self._record(self.balls, contacts=False)

    def _model(self) -> mujoco.MjModel:
        """Compiles the case."""
        xml = mjcf(self.case, self.balls)
        return model_of(
            self.method, self.case, xml, self.balls, tolerance=self.tolerance
        )

    def _record(self, balls: Balls, *, contacts: bool = True) -> Record:
        """Runs the case with these balls."""
        return record(
            self.case, balls, self.method, contacts=contacts, tolerance=self.tolerance
        )
