"""Bodies that go through each other, as the contacts of a run show it."""

from __future__ import annotations

import mujoco
import numpy as np

from mujoco_impact.encounters import Numbers, half_widths
from mujoco_impact.pulses import geom_name
from mujoco_impact.remarks import PASSING, Remark

THROUGH = 0.75
"""Overlap over the sum of half-widths from which bodies count as passing: `attach`
allows up to 0.5, and 1 is centre through centre."""

TOUCHING = 1e-9
"""Distance up to which geoms touch [m]: rounding."""


class Overlaps:
    """Looks for owned geoms that overlap deeper than any impact lets them."""

    def __init__(self, model: mujoco.MjModel, owned: Numbers) -> None:
        """Measures the geoms.

        Args:
            model: The model.
            owned: Ids of the owned geoms.
        """
        self._model = model
        self._ours = np.zeros(model.ngeom + 1, dtype=bool)
        self._ours[owned] = True
        # geom -1 is a flex
        self._widths = np.append(half_widths(model), np.inf)
        self._least = THROUGH * float(self._widths.min())
        self._worst = THROUGH
        self._found: tuple[float, float, str, str] | None = None
        self.touched = False

    def after_step(self, data: mujoco.MjData) -> None:
        """Looks at the contacts of the state that a step has started from.

        Deeper than a geom's depth a contact is MuJoCo's, so that its constraints tell
        where it is worth while to look.
        """
        if data.nefc and (not self.touched or data.efc_pos.min() < -self._least):
            self.look(data)

    def look(self, data: mujoco.MjData) -> None:
        """Looks at the contacts that `data` shows."""
        if not data.ncon:
            return
        contact = data.contact
        distance = contact.dist
        for index in np.flatnonzero(distance <= TOUCHING):
            first, second = contact.geom[index]
            if not (self._ours[first] or self._ours[second]):
                continue
            self.touched = True
            part = -float(distance[index]) / self._breadth(first, second)
            if part > self._worst:
                self._worst = part
                names = (geom_name(self._model, int(g)) for g in (first, second))
                start = float(data.time) - float(self._model.opt.timestep)
                self._found = (start, -float(distance[index]), *names)

    def remark(self) -> Remark | None:
        """Returns what to say about the deepest overlap, None if none is too deep."""
        if self._found is None:
            return None
        time, depth, first, second = self._found
        text = (
            f"{first!r} and {second!r} overlap by {depth:.3g} m at {time:.6g} s, "
            f"{self._worst:.2g} of their half-widths: they pass through each other. "
            "Likely cause: they met faster than the gap or the timestep allows, or "
            "they start like that; cure: a smaller timestep, attach(..., speed=) for "
            "the fastest body, another start"
        )
        return Remark(PASSING, text)

    def _breadth(self, first: int, second: int) -> float:
        """Returns the sum of half-widths of two geoms [m].

        A wall counts as no broader than what flies into it; a plane has no width.
        """
        low, high = sorted((float(self._widths[first]), float(self._widths[second])))
        return low + low if np.isfinite(high) else low
