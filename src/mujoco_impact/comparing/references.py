"""What the first impact should come to, where that is known without an engine.

* Several elastic spheres without friction, free or on slide joints, and planes: the
  Hertz problem, integrated (`reference.spheres`).
* One contact of any two bodies, without friction: the closed form of the rigid impact,
  v' = v + M⁻¹ Jᵀ P with P = (1 + e) u / (J M⁻¹ Jᵀ).

Friction does not matter where nothing slides at the contact, and the impact makes
nothing slide, as when a ball falls down straight.
"""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.comparing.first_impact import FirstImpact, velocities_at
from mujoco_impact.comparing.sphere_scene import (
    NoReference,
    free_acceleration,
    lifted,
    plane_of,
    spheres_of,
)
from mujoco_impact.comparing.survey import Survey
from mujoco_impact.errors import ImpactError
from mujoco_impact.pulses import geom_name
from mujoco_impact.reference.spheres import sphere_velocities
from mujoco_impact.trajectory import Array, Trajectory

SLIP = 1e-6
"""Sliding speed at a contact that is none, over the closing speed."""

REST = 1e-9
"""Distance up to which bodies touch beside the contact at hand [m]."""

JUST_BEFORE = 0.01
"""Part of a step before bodies touch at which their nearest points are asked for."""

HERTZ, CLOSED_FORM = "Hertz reference", "closed form"


@dataclasses.dataclass(frozen=True, eq=False)
class ImpactReference:
    """What the first impact leaves.

    Attributes:
        name: How it was computed.
        time: Time that the velocities belong to [s].
        velocities: Of the bodies of the impact [m/s], shape (n, 3).
        free: Their acceleration without impacts [m/s²], shape (n, 3).
    """

    name: str
    time: float
    velocities: Array
    free: Array

    def at(self, time: float) -> Array:
        """Returns the velocities at another time, without another impact."""
        later: Array = self.velocities + (time - self.time) * self.free
        return later


@dataclasses.dataclass(frozen=True)
class Material:
    """What the impacts of a scene are computed with.

    Attributes:
        restitution: Coefficient of restitution.
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        friction: Whether impacts have friction.
        hertz: Whether the impulses are those of Hertz contacts.
        uniform: Whether all bodies are of this material.
    """

    restitution: float = 1.0
    young: float = 2e11
    poisson: float = 0.3
    friction: bool = False
    hertz: bool = True
    uniform: bool = True


def impact_reference(
    model: mujoco.MjModel,
    motion: Trajectory,
    seen: Survey,
    first: FirstImpact,
    material: Material,
) -> tuple[ImpactReference | None, str]:
    """Returns the reference of the first impact, or None and why there is none.

    Args:
        model: The scene without the plugin.
        motion: Our motion.
        seen: What was seen of it.
        first: Its first impact.
        material: Material of the bodies.
    """
    try:
        return _Scene(model, motion, seen, first, material).reference(), ""
    except (NoReference, ImpactError) as reason:
        return None, f"no reference for the first impact: {reason}"


class _Scene:
    """The bodies of the first impact just before it."""

    def __init__(
        self,
        model: mujoco.MjModel,
        motion: Trajectory,
        seen: Survey,
        first: FirstImpact,
        material: Material,
    ) -> None:
        self._model, self._motion = model, motion
        self._first, self._material = first, material
        self._seen = seen
        sample = first.before
        self.free = free_acceleration(model, motion, seen, first.before, first.bodies)
        self._data = mujoco.MjData(model)
        self._data.qpos[:] = motion.qpos[sample]
        self._data.qvel[:] = motion.qvel[sample]
        mujoco.mj_forward(model, self._data)
        self._half = 0.5 * motion.timestep if motion.integrator != "RK4" else 0.0

    def reference(self) -> ImpactReference:
        """Returns the reference."""
        if not self._first.alone:
            raise NoReference("other impacts are under way, or the run ends in it")
        if not self._material.hertz:
            raise NoReference("the law is not that of Hertz contacts")
        if not self._material.uniform:
            raise NoReference("bodies are of different materials")
        if self._model.neq and self._data.ne:
            raise NoReference("bodies are tied to each other")
        self._check_slip()
        beside = self._beside()
        meetings = self._first.meetings
        if len(meetings) == 1 and meetings[0].points == 1 and not beside:
            return self._closed_form()
        if self._material.restitution < 1.0:
            raise NoReference("several contacts lose energy together")
        return self._hertz(beside)

    def _beside(self) -> set[int]:
        """Returns the geoms that touch the bodies of the impact, and one another."""
        bodies, found = set(self._first.bodies), set[int]()
        taking = {frozenset(one.geoms) for one in self._first.meetings}
        while True:
            before = len(found)
            for contact in self._data.contact:
                ids = contact.geom.tolist()
                names = frozenset(geom_name(self._model, geom) for geom in ids)
                owners = {int(self._model.geom_bodyid[geom]) for geom in ids}
                if contact.dist > REST or not owners & bodies or names in taking:
                    continue
                if contact.dim > 1:
                    one, other = sorted(names)
                    msg = f"{one!r} also touches {other!r}, with friction"
                    raise NoReference(msg)
                found.update(ids)
                bodies |= {b for b in owners if self._model.body_weldid[b] != 0}
            if len(found) == before:
                return found

    def _check_slip(self) -> None:
        """Raises if something slides at a contact with friction, or begins to.

        It begins to if the normal impulses give the surfaces a velocity along each
        other, T M⁻¹ N' with the rows N of all normals and T across the contact.
        """
        meetings = [
            self._rows([self._geom(name) for name in one.geoms])
            for one in self._first.meetings
        ]
        normals = np.array([normal @ rows for normal, rows in meetings])
        answer = np.zeros_like(normals)
        mujoco.mj_solveM(self._model, self._data, answer, normals)
        weight = np.abs(normals @ answer.T).max()
        for one, (normal, rows) in zip(self._first.meetings, meetings, strict=True):
            ids = [self._geom(name) for name in one.geoms]
            if not self._material.friction and not self._has_friction(ids):
                continue
            across = rows - np.outer(normal, normal @ rows)
            slides = np.linalg.norm(across @ self._data.qvel)
            begins = np.abs(across @ answer.T).max()
            if slides > SLIP * self._first.closing_speed or begins > SLIP * weight:
                first, second = one.geoms
                raise NoReference(
                    f"{first!r} and {second!r} slide on each other with friction in "
                    "MuJoCo's contacts (none: condim=1)"
                )

    def _rows(self, ids: list[int]) -> tuple[Array, Array]:
        """Returns the normal of a contact and the rows of its relative velocity."""
        normal, point = self._contact(ids[0], ids[1])
        first, second = (self._row(geom, point) for geom in ids)
        return normal, second - first

    def _has_friction(self, ids: list[int]) -> bool:
        """Returns whether MuJoCo's contact of two geoms has friction."""
        model = self._model
        priority = model.geom_priority[ids]
        if priority[0] != priority[1]:
            ids = [ids[int(np.argmax(priority))]]
        return bool(model.geom_condim[ids].max() > 1) and bool(
            model.geom_friction[ids, 0].max() > 1e-5
        )

    def _geom(self, name: str) -> int:
        """Returns the id of a geom by the name that impacts call it."""
        found = mujoco.mj_name2id(self._model, mujoco.mjtObj.mjOBJ_GEOM, name)
        return found if found >= 0 else int(name.rpartition(" ")[2])

    def _contact(self, first: int, second: int) -> tuple[Array, Array]:
        """Returns normal, from the first geom, and point of a contact."""
        model, data = self._model, self._data
        spheres = [
            model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE
            for geom in (first, second)
        ]
        centres = data.geom_xpos[[first, second]]
        if all(spheres):
            line = centres[1] - centres[0]
            normal = line / np.linalg.norm(line)
            return normal, centres[0] + model.geom_size[first, 0] * normal
        ends = np.zeros(6)
        # as far as anything moves in a step; MuJoCo's narrow phase is no contact model
        reach = 10.0 * self._first.closing_speed * self._motion.timestep
        distance = mujoco.mj_geomDistance(model, data, first, second, reach, ends)
        line = ends[3:] - ends[:3]
        length = float(np.linalg.norm(line))
        if length < REST:
            raise NoReference("the bodies already touch")
        return np.sign(distance) * line / length, 0.5 * (ends[3:] + ends[:3])

    def _row(self, geom: int, point: Array) -> Array:
        """Returns the Jacobian of a point of a geom's body, shape (3, nv)."""
        row = np.zeros((3, self._model.nv))
        body = int(self._model.geom_bodyid[geom])
        mujoco.mj_jac(self._model, self._data, row, None, point, body)
        return row

    def _closed_form(self) -> ImpactReference:
        """Returns the rigid impact of one contact."""
        model, data, first = self._model, self._data, self._first
        time = first.time - float(self._motion.time[first.before])
        # to where the bodies are just before they meet, and as fast as they then are
        rate = data.qacc.copy()
        data.qvel[:] += (time + self._half) * rate
        near = max(0.0, time - JUST_BEFORE * self._motion.timestep)
        mujoco.mj_integratePos(model, data.qpos, data.qvel - time / 2 * rate, near)
        mujoco.mj_forward(model, data)
        one, other = first.geoms
        normal, point = self._contact_there(one, other)
        row = normal @ (self._row(other, point) - self._row(one, point))
        answer = np.zeros((1, model.nv))
        mujoco.mj_solveM(model, data, answer, row[None])
        closing = -float(row @ data.qvel)
        impulse = (1.0 + self._material.restitution) * closing / float(row @ answer[0])
        data.qvel[:] += impulse * answer[0]
        mujoco.mj_fwdVelocity(model, data)
        bodies = list(first.bodies)
        arms = data.xipos[bodies] - data.subtree_com[model.body_rootid[bodies]]
        left = data.cvel[bodies, 3:] + np.cross(data.cvel[bodies, :3], arms)
        # while they touch the weight does nothing: they part as fast as they met
        parted = first.time + first.meetings[0].duration
        return ImpactReference(CLOSED_FORM, parted, left, self.free)

    def _contact_there(self, first: int, second: int) -> tuple[Array, Array]:
        """Returns normal and point of the contact that closes now, by its overlap."""
        try:
            return self._contact(first, second)
        except NoReference:
            for contact in self._data.contact:
                if set(contact.geom.tolist()) == {first, second}:
                    sign = 1.0 if contact.geom[0] == first else -1.0
                    return sign * contact.frame[:3], contact.pos.copy()
            raise

    def _hertz(self, beside: set[int]) -> ImpactReference:
        """Returns the elastic impact of spheres and planes.

        Args:
            beside: Geoms that touch the bodies of the impact.
        """
        model, first = self._model, self._first
        taking = {self._geom(name) for one in first.meetings for name in one.geoms}
        geoms = sorted(taking | beside)
        owners = [int(model.geom_bodyid[geom]) for geom in geoms]
        moving = [body for body in owners if model.body_weldid[body] != 0]
        bodies = tuple(dict.fromkeys([*first.bodies, *moving]))
        fixed = [
            geom
            for geom, body in zip(geoms, owners, strict=True)
            if model.body_weldid[body] == 0
        ]
        planes = [plane_of(model, self._data, geom) for geom in fixed]
        motion, before = self._motion, first.before
        free = free_acceleration(model, motion, self._seen, before, bodies)
        velocity = velocities_at(motion, self._seen, before, bodies, free)
        moved = spheres_of(model, self._data, bodies, velocity, free)
        spheres = [lifted(one, planes) for one in moved]
        end = float(self._motion.time[first.after])
        left = sphere_velocities(
            spheres,
            planes,
            end - float(self._motion.time[first.before]),
            young=self._material.young,
            poisson=self._material.poisson,
        )
        return ImpactReference(HERTZ, end, left[: len(first.bodies)], self.free)
