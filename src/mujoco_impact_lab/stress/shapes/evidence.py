"""What the promises of a case of shapes are judged by."""

from __future__ import annotations

import dataclasses
from functools import cached_property

import mujoco
import numpy as np

from mujoco_impact.impact import Impact
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.methods import OURS
from mujoco_impact_lab.stress.observe import Observation, energies, observe
from mujoco_impact_lab.stress.shapes.case import Case
from mujoco_impact_lab.stress.shapes.scene import Scene, scene_of


@dataclasses.dataclass(frozen=True, eq=False)
class Evidence:
    """Runs of one case under one method, and what follows from them, when asked for.

    Attributes:
        case: The case.
        method: Of `METHODS`.
    """

    case: Case
    method: str = OURS

    @cached_property
    def scene(self) -> Scene:
        """The scene."""
        return scene_of(self.case, self.method)

    @cached_property
    def run(self) -> Observation:
        """The case itself."""
        return observe(self.scene.model, self.scene.qvel, self.case.steps)

    @cached_property
    def again(self) -> Observation:
        """The same once more, with data of its own."""
        return observe(self.scene.model, self.scene.qvel, self.case.steps)

    @cached_property
    def renamed(self) -> Observation:
        """The same with its materials named the other way round."""
        scene = scene_of(self.case, self.method, renamed=True)
        return observe(scene.model, scene.qvel, self.case.steps)

    @cached_property
    def single(self) -> dict[int, Impact]:
        """The impacts that began alone in their step, by its number."""
        first = np.cumsum(self.run.begun) - self.run.begun
        steps = np.flatnonzero(self.run.begun == 1)
        return {int(step): self.run.impacts[first[step]] for step in steps}

    @cached_property
    def alone(self) -> Observation:
        """The case without any contact."""
        return observe(self.scene.apart, self.scene.qvel, self.case.steps)

    @cached_property
    def apart(self) -> tuple[Array, Array]:
        """Positions and velocities after each step, had it had no contact.

        Each step starts from the state that the run has there. Shapes (steps, nq) and
        (steps, nv).
        """
        run = self.run
        qpos, qvel = np.empty_like(run.qpos[1:]), np.empty_like(run.qvel[1:])
        for step in range(self.case.steps):
            qpos[step], qvel[step] = self._step_apart(run.qpos[step], run.qvel[step])
        return qpos, qvel

    @cached_property
    def energy(self) -> Array:
        """Potential and kinetic energy of each sample [J], shape (n_samples, 2)."""
        return self._energies(self.run.qpos, self.run.qvel)

    @cached_property
    def kinetic(self) -> float:
        """Largest kinetic energy of the run [J]."""
        return max(float(self.energy[:, 1].max()), 1e-300)

    @property
    def kinetic_at_start(self) -> float:
        """Kinetic energy of the first sample [J]."""
        return float(self.energy[0, 1])

    @cached_property
    def gained(self) -> Array:
        """Energy after each step beyond that without contacts [J], shape (steps,)."""
        apart = self._energies(*self.apart).sum(axis=1)
        gained: Array = self.energy[1:].sum(axis=1) - apart
        return gained

    @cached_property
    def integration(self) -> Array:
        """Energy that a step adds without contacts, unsigned [J], shape (steps + 1,).

        The last is that of a step beyond the run.
        """
        change = np.diff(self.energy.sum(axis=1)) - self.gained
        beyond = self._step_apart(self.run.qpos[-1], self.run.qvel[-1])
        after = self._energies(*(row[None] for row in beyond)).sum()
        result: Array = np.abs(np.append(change, after - self.energy[-1].sum()))
        return result

    @cached_property
    def height(self) -> Array | None:
        """How high the centres of geoms are above the floor, over half of their width.

        Shape (n_samples, n_geoms); NaN beside the floor, None if there is no floor.
        """
        scene = self.scene
        if scene.floor is None:
            return None
        model = scene.apart
        moving = np.flatnonzero(model.geom_bodyid != 0)
        centres = np.empty((self.case.steps + 1, len(moving), 3))
        data = mujoco.MjData(model)
        for sample, qpos in enumerate(self.run.qpos):
            data.qpos[:] = qpos
            mujoco.mj_kinematics(model, data)
            centres[sample] = data.geom_xpos[moving]
        half: Array = model.geom_aabb[moving, 3:].min(axis=1)
        return scene.floor.height(centres) / half

    def _step_apart(self, qpos: Array, qvel: Array) -> tuple[Array, Array]:
        """Returns position and velocity after a step without contact from a state."""
        data = self._free
        mujoco.mj_resetData(self.scene.apart, data)
        data.qpos[:], data.qvel[:] = qpos, qvel
        with collected_warnings():
            mujoco.mj_step(self.scene.apart, data)
        return data.qpos.copy(), data.qvel.copy()

    @cached_property
    def _free(self) -> mujoco.MjData:
        """Memory for steps without contact."""
        return mujoco.MjData(self.scene.apart)

    def _energies(self, qpos: Array, qvel: Array) -> Array:
        """Returns potential and kinetic energy of samples on their path [J].

        The semi-implicit integrators move bodies on a path with the velocity
        V = v + h/2 a: with v in its place a bounce would change the energy by u h a.
        The a of a body that tumbles is that of its spin halfway there.
        """
        model = self.scene.apart
        if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
            return energies(model, qpos, qvel)
        data, path = mujoco.MjData(model), qvel.copy()
        half = model.opt.timestep / 2
        for sample in range(len(qpos)):
            data.qpos[:], data.qvel[:] = qpos[sample], qvel[sample]
            mujoco.mj_forward(model, data)
            data.qvel[:] += half / 2 * data.qacc
            mujoco.mj_forward(model, data)
            path[sample] += half * data.qacc
        return energies(model, qpos, path)
