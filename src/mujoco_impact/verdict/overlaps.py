"""Bodies that go through each other, as the contacts of a run show it."""

from __future__ import annotations

import mujoco
import numpy as np

from mujoco_impact.pulses import geom_name
from mujoco_impact.remarks import PASSING, Remark
from mujoco_impact.verdict.encounters import Numbers, half_widths

THROUGH = 0.75
"""Overlap over the sum of half-widths from which bodies count as passing: `attach`
allows up to 0.5, and 1 is centre through centre."""

TOUCHING = 1e-9
"""Distance up to which geoms touch [m]: rounding."""


class Overlaps:
    """Looks for owned geoms that overlap deeper than any impact lets them."""

    def __init__(
        self, model: mujoco.MjModel, owned: Numbers, data: mujoco.MjData
    ) -> None:
        """Looks at the start.

        Args:
            model: The model.
            owned: Ids of the owned geoms.
            data: The state at the start.
        """
        self._model, self._scratch = model, mujoco.MjData(model)
        self._ours = np.zeros(model.ngeom + 1, dtype=bool)
        self._ours[owned] = True
        # geom -1 is a flex
        self._widths = np.append(half_widths(model), np.inf)
        self._least = THROUGH * float(self._widths.min())
        self.touched = False
        self._deepest, self._found = 0.0, ("", "", 0.0, 0.0)
        if owned.size:
            self.look(data)
        self._start = self._deepest

    def after_step(self, data: mujoco.MjData) -> None:
        """Looks at the state after a step, where it may be worth while.

        Deeper than a geom's depth a contact is MuJoCo's: its constraints tell.
        """
        if not data.nefc or data.efc_pos.min() >= -self._least:
            return
        deep = data.efc_pos < -self._least
        if np.any(data.efc_type[deep] >= _CONTACT):
            self.look(data)

    def look(self, data: mujoco.MjData) -> None:
        """Looks at the contacts of a state.

        Those that `data` holds may be of a stage of a Runge-Kutta step.
        """
        scratch = self._scratch
        scratch.qpos[:] = data.qpos
        scratch.mocap_pos[:], scratch.mocap_quat[:] = data.mocap_pos, data.mocap_quat
        mujoco.mj_fwdPosition(self._model, scratch)
        if not scratch.ncon:
            return
        contact = scratch.contact
        distance = contact.dist
        for index in np.flatnonzero(distance <= TOUCHING):
            first, second = contact.geom[index]
            if not (self._ours[first] or self._ours[second]):
                continue
            self.touched = True
            depth = -float(distance[index])
            part = depth / self._breadth(first, second)
            if part > self._deepest:
                names = [geom_name(self._model, int(geom)) for geom in (first, second)]
                self._deepest = part
                self._found = (names[0], names[1], depth, float(data.time))

    def remark(self) -> Remark | None:
        """Returns what to say about the deepest overlap, None if none is too deep."""
        if self._deepest - self._start <= THROUGH:
            return None
        first, second, depth, time = self._found
        text = (
            f"{first!r} and {second!r} overlap by {depth:.3g} m at {time:.6g} s, "
            f"{self._deepest:.2g} of their half-widths: they pass through each other; "
            "likely cause: they met faster than the timestep, or the softness of their "
            "pulses, allows; cure: a smaller timestep, shorter pulses, attach(..., "
            "speed=) for the fastest body"
        )
        return Remark(PASSING, text)

    def _breadth(self, first: int, second: int) -> float:
        """Returns the sum of half-widths of two geoms [m].

        A wall counts as no broader than what flies into it; a plane has no width.
        """
        low, high = sorted((float(self._widths[first]), float(self._widths[second])))
        return low + low if np.isfinite(high) else low


# the kinds of contacts come last
_CONTACT = int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)
