"""What is seen of an environment while it runs."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.impact import Impact
from mujoco_impact.pulses import PulseReader
from mujoco_impact.trajectory import Array


@dataclasses.dataclass
class Watch:
    """Looks at a model and its data after every step.

    Attributes:
        deepest: How far geoms were in each other [m].
        fastest: Largest velocity of a degree of freedom [m/s, rad/s].
        impacts: Impacts so far.
        energy: Largest energy that the impacts of a step have added [J].
        energy_part: The same over the kinetic energy at that time.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    plain: mujoco.MjModel
    deepest: float = 0.0
    fastest: float = 0.0
    impacts: int = 0
    energy: float = 0.0
    energy_part: float = 0.0

    def __post_init__(self) -> None:
        """Starts at the state of the data."""
        self._pulses = PulseReader(self.model, self.data)
        self._probe = mujoco.MjData(self.plain)
        self._before: tuple[Array, Array, Array] | None = None

    @property
    def missed(self) -> int:
        """Impacts without a record."""
        return self._pulses.missed

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
        self._pulses.poll()
        new = self._pulses.impacts[self.impacts :]
        self.impacts += len(new)
        if new and self._before is not None:
            self._judge(new, *self._before)

    def _judge(
        self, impacts: list[Impact], qpos: Array, qvel: Array, act: Array
    ) -> None:
        """Follows the bodies from impact to impact with the impulses of the record.

        An impulse p = J'P on bodies with the velocity v adds p.v + p.(p/M)/2.
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
        kinetic, added, now = 0.0, 0.0, 0.0
        push, product = np.zeros(model.nv), np.zeros(model.nv)
        for impact in sorted(impacts, key=lambda one: one.time):
            time = min(max(impact.time - start, 0.0), h)
            mujoco.mj_integratePos(model, probe.qpos, velocity, time - now)
            velocity = velocity + (time - now) * smooth
            now = time
            mujoco.mj_fwdPosition(model, probe)
            if kinetic == 0.0:
                mujoco.mj_mulM(model, probe, product, velocity)
                kinetic = float(velocity @ product) / 2
            impulse = impact.impulse * np.array(impact.normal)
            impulse += np.array(impact.tangential_impulse)
            push[:] = 0.0
            for sign, geom in zip((-1, 1), impact.geoms, strict=True):
                body = int(model.geom_bodyid[self._geom(geom)])
                mujoco.mj_applyFT(
                    model,
                    probe,
                    sign * impulse,
                    np.zeros(3),
                    np.array(impact.position),
                    body,
                    push,
                )
            change = _Ties(model, probe).change(push)
            added += float(push @ velocity + push @ change / 2)
            velocity = velocity + change
        if added > self.energy:
            self.energy = added
        self.energy_part = max(self.energy_part, added / max(kinetic, 1e-9))

    def _geom(self, name: str) -> int:
        """Returns the number of a geom of a record."""
        if name.startswith("geom "):
            return int(name[5:])
        return int(self.model.geom(name).id)


class _Ties:
    """What a force changes the velocities by in a step, over h.

    M + h B with Euler, B the damping of joints, divides a force f, and equality
    constraints with the rows J answer it: with A = J J'/(M + h B),

        a = (f - J' (A + R)^-1 (J f / (M + h B) - a_ref)) / (M + h B)
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Takes the inertia and the rows as `data` has them."""
        inertia = np.zeros((model.nv, model.nv))
        for row, unit in zip(inertia, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, row, unit)
        if model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4:
            inertia += np.diag(float(model.opt.timestep) * model.dof_damping)
        self._free = np.linalg.inv(inertia)
        rows = np.zeros((data.ne, model.nv))
        for row, unit in zip(rows, np.eye(data.nefc), strict=False):
            mujoco.mj_mulJacTVec(model, data, row, unit)
        self._rows, self._reference = rows, data.efc_aref[: data.ne].copy()
        held = rows @ self._free @ rows.T + np.diag(data.efc_R[: data.ne])
        self._held = np.linalg.inv(held)

    def change(self, push: Array) -> Array:
        """Returns what an impulse changes the velocity by, shape (nv,)."""
        free = self._free @ push
        answer: Array = self._free @ self._rows.T @ (self._held @ (self._rows @ free))
        return free - answer

    def acceleration(self, force: Array) -> Array:
        """Returns the acceleration under a force, shape (nv,)."""
        pull = self._free @ self._rows.T @ (self._held @ self._reference)
        result: Array = self.change(force) + pull
        return result
