"""The truth of the dominoes: stiff contacts with friction, integrated in time.

In the plane, for several pushes at a time. Corners press on the floor, and the upper
front corner of a stone on the back of the next one, with the forces of the law:

    F_n = K y^1.5,  dy/dt = c while it compresses, c / e^2 while it expands
    F_t within the cone of friction, so that the point does not slip if that is possible

c is the closing speed. Nothing here is shared with the law or the plugin: no impact is
looked for, and nothing is solved. Friction acts as an impulse in every step, one
contact after the other. A contact lasts some 0.15 ms, 15 steps. For the eight dominoes
of the benchmark times of arrival change by 1e-4 with steps of 0.4 of the length, and by
8e-4 with contacts a tenth as stiff.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, TypeAlias

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array

STIFFNESS, TIMESTEP = 1e9, 1e-5
"""K [N/m^1.5], and step [s]."""

Which: TypeAlias = slice | np.ndarray[Any, np.dtype[np.intp]]
"""Some of the stones of every row."""

LONGEST = 1.0
"""Time by which the wave must have arrived [s]."""


@dataclasses.dataclass(frozen=True)
class Row:
    """A row of equal stones on a floor, in SI units."""

    count: int
    height: float
    thickness: float
    mass: float
    pitch: float
    friction: float
    restitution: float
    gravity: float

    @classmethod
    def of(cls, model: mujoco.MjModel, restitution: float) -> Row:
        """Returns the row of a model that `cradle_models.dominoes` made."""
        stone = model.geom("stone_1")
        places = model.key_qpos[0].reshape(-1, 7)[:, 0]
        return cls(
            count=model.nbody - 1,
            height=2 * float(stone.size[2]),
            thickness=2 * float(stone.size[0]),
            mass=float(model.body_mass[1]),
            pitch=float(places[1] - places[0]),
            friction=float(stone.friction[0]),
            restitution=restitution,
            gravity=-float(model.opt.gravity[2]),
        )


def arrivals(
    row: Row,
    pushes: Sequence[float],
    angle: float,
    *,
    stiffness: float = STIFFNESS,
    timestep: float = TIMESTEP,
) -> Array:
    """Returns when the last stone has turned by an angle [s], shape (pushes,).

    Args:
        row: The stones.
        pushes: How fast the first stone turns about its front edge [rad/s].
        angle: [rad].
        stiffness: K [N/m^1.5].
        timestep: [s].
    """
    stones = _Stones(row, np.asarray(pushes), stiffness, timestep)
    times = np.full(len(pushes), np.nan)
    before = stones.tilt[:, -1].copy()
    for step in range(1, round(LONGEST / timestep)):
        stones.step()
        now = stones.tilt[:, -1]
        arrived = np.isnan(times) & (now > angle)
        late = (now - angle)[arrived] / (now - before)[arrived]
        times[arrived] = (step - late) * timestep
        if not np.isnan(times).any():
            return times
        before = now.copy()
    msg = f"the last of {row.count} dominoes does not fall within {LONGEST} s"
    raise ValueError(msg)


class _Stones:
    """State of the stones of all rows, arrays of shape (pushes, stones).

    `x`, `z` are places of the centres, `tilt` turns the top towards +x.
    """

    def __init__(
        self, row: Row, pushes: Array, stiffness: float, timestep: float
    ) -> None:
        shape = (len(pushes), row.count)
        self._row, self._stiffness, self._h = row, stiffness, timestep
        self.x = np.broadcast_to(row.pitch * np.arange(row.count), shape).copy()
        self.z = np.full(shape, row.height / 2)
        self.tilt, self._spin = np.zeros(shape), np.zeros(shape)
        self._vx, self._vz = np.zeros(shape), np.zeros(shape)
        # about the lower front edge
        self._spin[:, 0] = pushes
        self._vx[:, 0] = pushes * row.height / 2
        self._vz[:, 0] = pushes * row.thickness / 2
        self._inertia = row.mass * (row.height**2 + row.thickness**2) / 12
        b, h = row.thickness / 2, row.height / 2
        # the first corner is the upper front one
        self._corners = ((b, h), (b, -h), (-b, -h), (-b, h))
        # overlap, and y of the law, of four corners and of the pair with the next stone
        self._overlap, self._y = np.zeros((5, *shape)), np.zeros((5, *shape))

    def step(self) -> None:
        """Makes one step: normal forces, friction, then the way."""
        cos, sin = np.cos(self.tilt), np.sin(self.tilt)
        arms = [(cos * p + sin * q, cos * q - sin * p) for p, q in self._corners]
        # of the corner from the centre of the next stone
        ahead = (
            self.x[:, :-1] + arms[0][0][:, :-1] - self.x[:, 1:],
            self.z[:, :-1] + arms[0][1][:, :-1] - self.z[:, 1:],
        )
        impulses = self._normal_impulses(arms, ahead, cos, sin)
        self._vz -= self._row.gravity * self._h
        for (ax, az), P in zip(arms, impulses[:4], strict=True):
            self._push(slice(None), ax, az, 0.0, P)
        pair = slice(0, -1), slice(1, None)
        front = arms[0][0][:, :-1], arms[0][1][:, :-1]
        normal = cos[:, 1:], -sin[:, 1:]
        P = impulses[4, :, :-1]
        self._exchange(*pair, front, ahead, normal, P)
        self._rub(arms, front, ahead, (sin[:, 1:], cos[:, 1:]), impulses)
        self.x += self._h * self._vx
        self.z += self._h * self._vz
        self.tilt += self._h * self._spin

    def _normal_impulses(
        self, arms: list[tuple[Array, Array]], ahead: tuple[Array, Array],
        cos: Array, sin: Array,
    ) -> Array:  # fmt: skip
        """Returns F_n h of all contacts, shape (5, pushes, stones)."""
        overlap = np.zeros_like(self._overlap)
        for k, (_, az) in enumerate(arms):
            overlap[k] = -(self.z + az)
        # in the frame of the next stone: behind its back, or in front of it
        along = cos[:, 1:] * ahead[0] - sin[:, 1:] * ahead[1]
        up = sin[:, 1:] * ahead[0] + cos[:, 1:] * ahead[1]
        beside = np.abs(up) < self._row.height / 2
        overlap[4, :, :-1] = np.where(beside, along + self._row.thickness / 2, 0.0)
        overlap = np.maximum(overlap, 0.0)
        change = overlap - self._overlap
        expanding = max(self._row.restitution, 1e-3) ** 2
        y = self._y + np.where(change > 0, change, change / expanding)
        self._y = np.where(overlap > 0, np.maximum(y, 0.0), 0.0)
        self._overlap = overlap
        return np.asarray(self._stiffness * self._y**1.5 * self._h)

    def _rub(
        self, arms: list[tuple[Array, Array]], front: tuple[Array, Array],
        ahead: tuple[Array, Array], along: tuple[Array, Array], impulses: Array,
    ) -> None:  # fmt: skip
        """Stops the slip of every contact, as far as its friction can."""
        mobility, mass = 1 / self._inertia, self._row.mass
        for (ax, az), P in zip(arms, impulses[:4], strict=True):
            slip = self._vx + self._spin * az
            most = self._row.friction * P
            rub = np.clip(-slip / (1 / mass + az**2 * mobility), -most, most)
            self._push(slice(None), ax, az, rub, 0.0)
        tx, tz = along
        # every second pair: neighbours share a stone
        for first in (0, 1):
            some = np.arange(first, self._row.count - 1, 2)
            one, other = some, some + 1
            fx, fz, gx, gz, sx, sz = (
                a[:, some] for a in (*front, *ahead, tx, tz)
            )  # fmt: skip
            arm, far = fz * sx - fx * sz, gz * sx - gx * sz
            slip = (
                (self._vx[:, one] - self._vx[:, other]) * sx
                + (self._vz[:, one] - self._vz[:, other]) * sz
                + arm * self._spin[:, one]
                - far * self._spin[:, other]
            )
            most = self._row.friction * impulses[4][:, some]
            W = 2 / mass + (arm**2 + far**2) * mobility
            rub = np.clip(slip / W, -most, most)
            self._exchange(one, other, (fx, fz), (gx, gz), (sx, sz), rub)

    def _exchange(
        self, one: Which, other: Which, arm: tuple[Array, Array],
        far: tuple[Array, Array], way: tuple[Array, Array], P: Array,
    ) -> None:  # fmt: skip
        """Gives impulses along a way to the other stones, and their opposite to one."""
        self._push(one, *arm, -way[0] * P, -way[1] * P)
        self._push(other, *far, way[0] * P, way[1] * P)

    def _push(
        self, which: Which, ax: Array, az: Array, Px: Array | float,
        Pz: Array | float,
    ) -> None:  # fmt: skip
        """Gives impulses to stones at arms from their centres [N s]."""
        self._vx[:, which] += Px / self._row.mass
        self._vz[:, which] += Pz / self._row.mass
        # about y, which turns z to x
        self._spin[:, which] += (az * Px - ax * Pz) / self._inertia
