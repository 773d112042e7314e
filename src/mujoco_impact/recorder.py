"""Filling the arrays of a trajectory while a simulation runs."""

from __future__ import annotations

import copy
import warnings

import mujoco
import numpy as np

from mujoco_impact.errors import ImpactWarning
from mujoco_impact.pulses import PulseReader
from mujoco_impact.remarks import QUIET
from mujoco_impact.trajectory import Array, Trajectory
from mujoco_impact.verdict import RunWatch
from mujoco_impact.verdict.mocap_bodies import mocap_bodies, potential


class Recorder:
    """Fills the arrays of a trajectory while a simulation runs."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        samples: int,
        every: int,
        controlled: bool,
        start: str,
    ) -> None:
        """Records the state of `data`.

        Args:
            model: The model.
            data: The data that is stepped.
            samples: How many states to keep.
            every: Steps between two of them.
            controlled: Whether a controller may change state and applied forces.
            start: What the run starts from, in words.
        """
        self._start = start
        self._samples = 0
        self._model = model
        self._data = data
        self._time: Array = np.zeros(samples)
        self._qpos: Array = np.zeros((samples, model.nq))
        self._qvel: Array = np.zeros((samples, model.nv))
        self._energy: Array = np.zeros((samples, 2))
        self._pulses = PulseReader(model, data)
        # A Runge-Kutta step leaves the energy of its last stage, not of its start.
        self._runge_kutta = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
        self._scratch = copy.copy(data)
        self._by_hand = mocap_bodies(model)
        self.watch = RunWatch(model, data, every=every, controlled=controlled)
        self._sample(0)

    def after_step(self, step: int, every: int) -> None:
        """Records what step number `step` (from 0) brought."""
        self._pulses.poll()
        self.watch.after_step()
        if step % every == 0 and not self._runge_kutta:
            # a step computes the energy of the state that it starts from
            self._energy[step // every] = self._energy_of(self._data)
        if (step + 1) % every == 0:
            self._sample((step + 1) // every)

    def trajectory(self, *, failed: bool = False) -> Trajectory:
        """Returns what was recorded so far, and warns of what it has to say.

        Args:
            failed: Whether the step from the last sample failed: that sample is kept,
                and not judged.
        """
        count = self._samples
        if not self._runge_kutta:
            # the step from the last sample has not been taken
            self._energy[count - 1] = self._energy_at(count - 1)
        if self._pulses.missed:
            warnings.warn(
                f"{self._pulses.missed} impacts have no record: more of them began in "
                "one step than the plugin has slots; their motion is computed",
                ImpactWarning,
                stacklevel=3,
            )
        time, energy = self._time[:count], self._energy[:count]
        judged = count - 1 if failed else count
        remarks = self.watch.remarks(
            time[:judged], energy[:judged], self._pulses.impacts
        )
        for remark in remarks:
            if remark.kind not in QUIET:
                warnings.warn(remark.text, ImpactWarning, stacklevel=3)
        return Trajectory(
            time=time,
            qpos=self._qpos[:count],
            qvel=self._qvel[:count],
            energy=energy,
            impacts=tuple(sorted(self._pulses.impacts, key=lambda one: one.time)),
            timestep=float(self._model.opt.timestep),
            integrator=integrator_name(self._model),
            mujoco_version=mujoco.mj_versionString(),
            missed_impacts=self._pulses.missed,
            remarks=remarks,
            start=self._start,
        )

    def _sample(self, index: int) -> None:
        """Records the present state."""
        self._time[index] = self._data.time
        self._qpos[index] = self._data.qpos
        self._qvel[index] = self._data.qvel
        if self._runge_kutta:
            self._energy[index] = self._energy_at(index)
        self._samples = index + 1

    def _energy_at(self, sample: int) -> Array:
        """Returns potential and kinetic energy of a sample [J], shape (2,)."""
        self._scratch.qpos[:] = self._qpos[sample]
        self._scratch.qvel[:] = self._qvel[sample]
        self._scratch.mocap_pos[:] = self._data.mocap_pos
        self._scratch.mocap_quat[:] = self._data.mocap_quat
        find_energies(self._model, self._scratch)
        return self._energy_of(self._scratch)

    def _energy_of(self, data: mujoco.MjData) -> Array:
        """Returns the energies in `data` without the weight of mocap bodies [J]."""
        energy: Array = np.array(data.energy)
        if self._by_hand.size:
            energy[0] -= potential(self._model, data, self._by_hand)
        return energy


def integrator_name(model: mujoco.MjModel) -> str:
    """Returns the integrator as MJCF spells it, for example "Euler" or "RK4"."""
    name = str(mujoco.mjtIntegrator(model.opt.integrator).name)
    name = name.removeprefix("mjINT_")
    return {"EULER": "Euler", "RK4": "RK4"}.get(name, name.lower())


def find_energies(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Fills in `data.energy` [J] from the positions and velocities in `data`.

    Nothing beyond what the energies read is computed: neither contacts nor plugins.
    """
    for stage in (
        mujoco.mj_kinematics,
        mujoco.mj_comPos,
        mujoco.mj_tendon,
        mujoco.mj_makeM,
        mujoco.mj_energyPos,
        mujoco.mj_energyVel,
    ):
        stage(model, data)
