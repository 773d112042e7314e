"""Bodies that are faster than their gap: impacts that no contact announces.

MuJoCo finds a contact from the gap on. A body that covers more than that within one
step may be in front of another at the start of a step and behind it at the end, and
nobody has seen a contact.
"""

from __future__ import annotations

import dataclasses
import math

import mujoco
import numpy as np

from mujoco_impact.ownership import gap_for_speed
from mujoco_impact.pulses import geom_name
from mujoco_impact.remarks import FAST, Remark
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.encounters import Numbers, meetings, sights
from mujoco_impact.verdict.mocap_bodies import MocapMotion
from mujoco_impact.verdict.step_log import StepLog

MOST_PAIRS = 16
"""Pairs looked at closely in one step, nearest first."""

MOST_STATES = 500
"""States of a rollout looked at closely in one call of MuJoCo: some milliseconds."""


@dataclasses.dataclass(frozen=True)
class Approach:
    """Two geoms that meet within a step although no contact announced it.

    Attributes:
        time: Start of that step [s].
        geoms: Their names.
        speed: Closing speed [m/s].
        sight: Distance from which their contact is seen [m].
    """

    time: float
    geoms: tuple[str, str]
    speed: float
    sight: float


@dataclasses.dataclass(frozen=True)
class Approaches:
    """Approaches that no contact announced.

    Attributes:
        count: How many there were.
        first: Time of the first of them [s].
        fastest: The fastest of them.
    """

    count: int = 0
    first: float = math.inf
    fastest: Approach | None = None

    def __add__(self, other: Approaches) -> Approaches:
        """Returns these and later ones."""
        both = [one.fastest for one in (self, other) if one.fastest is not None]
        return Approaches(
            self.count + other.count,
            min(self.first, other.first),
            max(both, key=lambda approach: approach.speed, default=None),
        )

    def remark(self, timestep: float) -> Remark | None:
        """Returns what to say about the fastest, None if there is none.

        Args:
            timestep: Of the model [s].
        """
        worst = self.fastest
        if worst is None:
            return None
        gap = gap_for_speed(worst.speed, timestep)
        seen = "once" if self.count == 1 else f"{self.count} times, the fastest"
        text = (
            f"{worst.geoms[0]!r} closes in on {worst.geoms[1]!r} at {worst.speed:.4g} "
            f"m/s, {worst.speed * timestep:.3g} m in one step of {timestep:g} s, but "
            f"their contact is seen only from {worst.sight:.3g} m on ({seen} at "
            f"{worst.time:.6g} s): the impact is missed or comes too late; cure: "
            f"attach(..., speed={worst.speed:.3g}) or gap={gap:g}, or a smaller "
            "timestep"
        )
        return Remark(FAST, text)


class FastBodies:
    """Looks for owned geoms that close in on others faster than their gap allows.

    Attributes:
        needs: What of `mjData` must be logged after each step.
        found: What it has found.
    """

    def __init__(self, model: mujoco.MjModel, owned: Numbers) -> None:
        """Finds out what can meet.

        Args:
            model: The model.
            owned: Ids of the owned geoms.
        """
        mates = meetings(model, owned)
        able = mates.any(axis=1)
        self._model = model
        self._owned, self._mates = owned[able], mates[able]
        self._sight = sights(model, self._owned)
        moving = model.body_weldid[model.geom_bodyid] != 0
        self._met = np.flatnonzero(self._mates.any(axis=0) & moving)
        self._watched = np.union1d(self._owned, self._met)
        self._bodies = model.geom_bodyid[self._watched]
        self._roots = model.body_rootid[self._bodies]
        # how far a turn carries the surface: not at all for a sphere
        round_ = model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE
        self._extent = np.where(round_, 0.0, model.geom_rbound)
        self._slack = float(
            np.where(self._mates, self._sight, np.inf).min(initial=np.inf)
        )
        self._scratch = mujoco.MjData(model)
        self._segment = np.zeros(6)
        self._mocap = MocapMotion(model)
        seen = ("cvel", "geom_xpos", "subtree_com", *self._mocap.needs)
        self.needs: tuple[str, ...] = seen if self._watched.size else ()
        self.found = Approaches()

    def look(self, log: StepLog) -> None:
        """Looks at the logged steps."""
        if not self._watched.size:
            return
        cvel = self._mocap.velocities(log)
        ways = self._ways(cvel, log["geom_xpos"], log["subtree_com"])
        # no two of them come nearer in a step than any of them sees
        fast = np.flatnonzero(2.0 * ways.max(axis=1) > self._slack)
        if not fast.size:
            return
        qpos, qvel = log.before("qpos"), log.before("qvel")
        for step in fast:
            for name in self._mocap.needs:
                getattr(self._scratch, name)[:] = log[name][step]
            time = log.start + int(step) * float(self._model.opt.timestep)
            by_hand = cvel[step, self._mocap.bodies]
            self._look_from(qpos[step], qvel[step], time, by_hand)

    def look_at_fastest(self, time: Array, qpos: Array, qvel: Array) -> None:
        """Looks at the steps from the fastest of many states.

        Args:
            time: Their times [s], shape (n,).
            qpos: Positions, shape (n, nq).
            qvel: Velocities, shape (n, nv).
        """
        if not self._watched.size:
            return
        score = np.abs(qvel) @ self._levers()
        fast = np.flatnonzero(2.0 * score * self._model.opt.timestep > self._slack)
        for index in fast[np.argsort(-score[fast])[:MOST_STATES]]:
            self._look_from(qpos[index], qvel[index], float(time[index]))

    def remark(self) -> Remark | None:
        """Returns what to say about the fastest approach, None if there is none."""
        return self.found.remark(float(self._model.opt.timestep))

    def _levers(self) -> Array:
        """Returns how far a unit of each velocity can move something [m], (nv,)."""
        model = self._model
        levers = np.full(model.nv, float(model.stat.extent))
        linear = model.jnt_type == int(mujoco.mjtJoint.mjJNT_SLIDE)
        levers[model.jnt_dofadr[linear]] = 1.0
        for joint in np.flatnonzero(model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)):
            first = int(model.jnt_dofadr[joint])
            levers[first : first + 3] = 1.0
            # a free body that carries nothing turns about itself
            body = int(model.jnt_bodyid[joint])
            if not np.any(model.body_parentid == body):
                own = np.flatnonzero(model.geom_bodyid == body)
                arms = np.linalg.norm(model.geom_pos[own], axis=1) + self._extent[own]
                levers[first + 3 : first + 6] = arms.max(initial=0.0)
        return levers

    def _ways(self, cvel: Array, position: Array, centre: Array) -> Array:
        """Returns at most how far each watched surface moves in a step [m].

        Args:
            cvel: As in `mjData`, shape (steps, nbody, 6).
            position: `geom_xpos`, shape (steps, ngeom, 3).
            centre: `subtree_com`, shape (steps, nbody, 3).
        """
        velocity = cvel[:, self._bodies]
        arm = position[:, self._watched] - centre[:, self._roots]
        spin, speed, lever = (
            np.sqrt(np.einsum("kij,kij->ki", vector, vector))
            for vector in (velocity[..., :3], velocity[..., 3:], arm)
        )
        ways: Array = speed + spin * (lever + self._extent[self._watched])
        return ways * float(self._model.opt.timestep)

    def _look_from(
        self, qpos: Array, qvel: Array, time: float, by_hand: Array | float = 0.0
    ) -> None:
        """Looks at the step from one state, `by_hand` the `cvel` of mocap bodies."""
        data = self._scratch
        data.qpos[:], data.qvel[:], data.time = qpos, qvel, time
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):
            stage(self._model, data)
        data.cvel[self._mocap.bodies] = by_hand
        ways = self._ways(data.cvel[None], data.geom_xpos[None], data.subtree_com[None])
        self._look_closely(data, ways[0])

    def _look_closely(self, data: mujoco.MjData, ways: Array) -> None:
        """Looks at the pairs that may meet within the step."""
        model = self._model
        way = np.zeros(model.ngeom)
        way[self._watched] = ways
        reach = way[self._owned][:, None] + way
        possible = self._mates & (reach > self._sight)
        if not possible.any():
            return
        rows, others = np.nonzero(possible)
        first = self._owned[rows]
        between = data.geom_xpos[others] - data.geom_xpos[first]
        radius = model.geom_rbound
        # planes and height fields have no radius: they are near
        bounded = radius[others] > 0
        space = np.linalg.norm(between, axis=1) - radius[first] - radius[others]
        space = np.where(bounded & (radius[first] > 0), space, 0.0)
        near = space < reach[rows, others]
        order = np.argsort(space[near])[:MOST_PAIRS]
        for row, other in zip(rows[near][order], others[near][order], strict=True):
            self._look_at_pair(data, int(row), int(other), float(reach[row, other]))

    def _look_at_pair(
        self, data: mujoco.MjData, row: int, other: int, reach: float
    ) -> None:
        """Notes the approach of a pair that meets within the step, unseen."""
        model, owned = self._model, int(self._owned[row])
        sight = float(self._sight[row, other])
        distance = float(
            mujoco.mj_geomDistance(model, data, owned, other, reach, self._segment)
        )
        if not sight < distance < reach:
            return
        normal = (self._segment[3:] - self._segment[:3]) / distance
        speed = 0.0
        for geom, side in ((owned, 0), (other, 1)):
            body = int(model.geom_bodyid[geom])
            # mj_objectVelocity knows nothing of mocap bodies
            moved, centre = data.cvel[body], data.subtree_com[model.body_rootid[body]]
            arm = self._segment[3 * side : 3 * side + 3] - centre
            sign = 1.0 if side == 0 else -1.0
            speed += sign * float((moved[3:] + np.cross(moved[:3], arm)) @ normal)
        if speed * float(model.opt.timestep) <= distance:
            return
        names = (geom_name(model, owned), geom_name(model, other))
        time = float(data.time)
        approach = Approach(time, names, speed, sight)
        self.found += Approaches(1, time, approach)
