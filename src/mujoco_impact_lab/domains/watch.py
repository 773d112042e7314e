"""What is seen of an environment while it runs."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
import scipy.optimize

from mujoco_impact.impact import Impact
from mujoco_impact.pulses import PulseReader, plugin_instances, step_work
from mujoco_impact.trajectory import Array

_NEAR_END = 1e-2
"""So far from the end of its range a joint may reach it in an impact [m or rad]."""

_EARLY = 0.1
"""A joint is at a stop that it reaches in this part of an impact, unless it leaves it
faster than with this part of the push (plugin/engine/path/stops.h)."""


_SAME_IMPACT = 0.05
"""Of a step: what begins within it presses on stops together."""


@dataclasses.dataclass
class Watch:
    """Looks at a model and its data after every step.

    Attributes:
        deepest: How far geoms were in each other [m].
        fastest: Largest velocity of a degree of freedom [m/s, rad/s].
        impacts: Impacts so far.
        energy: Largest energy that the impacts of a step have added [J].
        kinetic: Largest kinetic energy before an impact [J].
        work: Work of the last step of the plugin, over what a step may do.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    plain: mujoco.MjModel
    deepest: float = 0.0
    fastest: float = 0.0
    impacts: int = 0
    energy: float = 0.0
    kinetic: float = 0.0
    work: float = 0.0

    def __post_init__(self) -> None:
        """Starts at the state of the data."""
        self._pulses = PulseReader(self.model, self.data)
        self._instances = plugin_instances(self.model)
        self._probe = mujoco.MjData(self.plain)
        self._before: tuple[Array, Array, Array] | None = None

    @property
    def recorded(self) -> list[Impact]:
        """The impacts."""
        return self._pulses.impacts

    def before_step(self) -> None:
        """Notes the state that the step starts from."""
        data = self.data
        self._before = data.qpos.copy(), data.qvel.copy(), data.act.copy()

    def after_step(self) -> None:
        """Looks at what the step did: the contacts are those of its start."""
        data = self.data
        if data.ncon:
            self.deepest = max(self.deepest, -float(data.contact.dist.min()))
        self.fastest = max(self.fastest, float(np.abs(data.qvel).max()))
        self.work = step_work(self.model, data, self._instances)
        self._pulses.poll()
        new = self.recorded[self.impacts :]
        self.impacts += len(new)
        if new and self._before is not None:
            self.judge(new, *self._before)

    def judge(
        self, impacts: list[Impact], qpos: Array, qvel: Array, act: Array
    ) -> None:
        """Follows the bodies from impact to impact with the impulses of the record.

        The contacts that carry them meanwhile are left out. An impulse p = J'P, with
        that of the joint stops that it presses on, adds p.v + p.(p/M)/2 to bodies with
        the velocity v.
        """
        model, probe = self.plain, self._probe
        h = float(model.opt.timestep)
        start = self.data.time - h
        probe.qpos[:], probe.qvel[:], probe.act[:] = qpos, qvel, act
        probe.ctrl[:] = self.data.ctrl
        mujoco.mj_forward(model, probe)
        smooth = _Ties(model, probe).acceleration(probe.qfrc_smooth)
        # the path of the semi-implicit integrators
        euler = model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4
        velocity = qvel + (h / 2 * smooth if euler else 0.0)
        first, added, now = True, 0.0, 0.0
        push, product = np.zeros(model.nv), np.zeros(model.nv)
        for together in _groups(impacts, _SAME_IMPACT * h):
            time = min(max(together[0].time - start, 0.0), h)
            mujoco.mj_integratePos(model, probe.qpos, velocity, time - now)
            velocity = velocity + (time - now) * smooth
            now = time
            mujoco.mj_fwdPosition(model, probe)
            if first:
                mujoco.mj_mulM(model, probe, product, velocity)
                self.kinetic = max(self.kinetic, float(velocity @ product) / 2)
                first = False
            push[:] = 0.0
            for impact in together:
                self._add_push(impact, push)
            ties = _Ties(model, probe)
            lasts = max(impact.duration for impact in together)
            push += ties.stopped(push, velocity, lasts, *_ends(model, probe))
            change = ties.change(push)
            added += float(push @ velocity + push @ change / 2)
            velocity = velocity + change
        self.energy = max(self.energy, added)

    def _add_push(self, impact: Impact, push: Array) -> None:
        """Adds J'P, the bodies being where the probe has them."""
        impulse = impact.impulse * np.array(impact.normal)
        impulse += np.array(impact.tangential_impulse)
        place = np.array(impact.position)
        for sign, geom in zip((-1, 1), impact.geoms, strict=True):
            body = int(self.model.geom_bodyid[self._geom(geom)])
            force, torque = sign * impulse, np.zeros(3)
            mujoco.mj_applyFT(self.plain, self._probe, force, torque, place, body, push)

    def _geom(self, name: str) -> int:
        """Returns the number of a geom of a record."""
        if name.startswith("geom "):
            return int(name[5:])
        return int(self.model.geom(name).id)


def _groups(impacts: list[Impact], time: float) -> list[list[Impact]]:
    """Returns the impacts in order of time, those that begin together in one list."""
    groups: list[list[Impact]] = []
    for impact in sorted(impacts, key=lambda one: one.time):
        if groups and impact.time - groups[-1][0].time < time:
            groups[-1].append(impact)
        else:
            groups.append([impact])
    return groups


def _ends(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, Array]:
    """Returns a row and the gap of each end that a hinge or a slide is near."""
    rows, gaps = [], []
    for joint in np.flatnonzero(model.jnt_limited):
        if model.jnt_type[joint] < int(mujoco.mjtJoint.mjJNT_SLIDE):
            continue
        value = data.qpos[model.jnt_qposadr[joint]]
        below, above = model.jnt_range[joint]
        for side, gap in ((1, value - below), (-1, above - value)):
            if gap < _NEAR_END:
                row = np.zeros(model.nv)
                row[model.jnt_dofadr[joint]] = side
                rows.append(row)
                gaps.append(gap - model.jnt_margin[joint])
    return np.array(rows).reshape(-1, model.nv), np.array(gaps)


class _Ties:
    """What a force changes the velocities by in a step, over h.

    Equality constraints with the rows J answer a force f on the bodies as they are,
    and Euler's step divides both by the inertia with the damping B of the joints:

        f_J = J' (J M^-1 J' + R)^-1 (a_ref - J M^-1 f),  a = (M + h B)^-1 (f + f_J)
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Takes the inertia and the rows as `data` has them."""
        inertia = np.zeros((model.nv, model.nv))
        for row, unit in zip(inertia, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, row, unit)
        damped = inertia.copy()
        if model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4:
            damped += np.diag(float(model.opt.timestep) * model.dof_damping)
        self._damped = np.linalg.inv(damped)
        rows = np.zeros((data.ne, model.nv))
        for row, unit in zip(rows, np.eye(data.nefc), strict=False):
            mujoco.mj_mulJacTVec(model, data, row, unit)
        self._rows, self._reference = rows, data.efc_aref[: data.ne].copy()
        self._answer = rows @ np.linalg.inv(inertia)
        held = self._answer @ rows.T + np.diag(data.efc_R[: data.ne])
        self._held = np.linalg.inv(held)

    def change(self, push: Array) -> Array:
        """Returns what an impulse changes the velocity by, shape (nv,)."""
        tied = self._rows.T @ (self._held @ (self._answer @ push))
        changed: Array = self._damped @ (push - tied)
        return changed

    def stopped(
        self, push: Array, velocity: Array, lasts: float, rows: Array, gaps: Array
    ) -> Array:
        """Returns what joints at the ends of their ranges answer, shape (nv,).

        Args:
            push: Impulse, shape (nv,).
            velocity: Before it, shape (nv,).
            lasts: For how long the impact lasts [s].
            rows: A row for each end, positive away from it, shape (n, nv).
            gaps: Distance from the end, shape (n,) [m or rad].
        """
        if not len(rows):
            return np.zeros_like(push)
        leaving = np.maximum(rows @ velocity, 0.0)
        room = np.maximum(gaps - 1e-6, 0.0) / (_EARLY * lasts) + leaving / _EARLY
        held = rows[self._answers(rows, self.change(push), room) > 0]
        if not len(held):
            return np.zeros_like(push)
        impulse = self._answers(held, self.change(push), np.zeros(len(held)))
        result: Array = held.T @ impulse
        return result

    def _answers(self, rows: Array, change: Array, room: Array) -> Array:
        """Returns L with 0 <= L, 0 <= A L + b, and one of them zero, shape (n,).

        A = S M^-1 S' of the rows S, b = S change + room. It is the least
        |C L + b/C'| with A = C'C.
        """
        matrix = rows @ np.array([self.change(row) for row in rows]).T
        matrix += 1e-9 * np.trace(matrix) * np.eye(len(rows))
        factor = np.linalg.cholesky(matrix).T
        target = -np.linalg.solve(factor.T, rows @ change + room)
        answer: Array = scipy.optimize.nnls(factor, target)[0]
        return answer

    def acceleration(self, force: Array) -> Array:
        """Returns the acceleration under a force, shape (nv,)."""
        pull = self._rows.T @ (self._held @ self._reference)
        result: Array = self.change(force) + self._damped @ pull
        return result
