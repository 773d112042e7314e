"""One run of a scene and what is wrong with it."""

from __future__ import annotations

import mujoco
import numpy as np

from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.pulses import PulseReader
from mujoco_impact.recordings import check_recording
from mujoco_impact.remarks import ENERGY, FAST, PASSING
from mujoco_impact.runner import initial_data, step_count
from mujoco_impact.starts import Keyframe
from mujoco_impact.stress.differences import Outcome
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict import RunWatch

NAMED = 3
"""Keyframes that a message names."""


class WatchedRun:
    """One run of a scene and what was seen in it."""

    def __init__(
        self,
        model: mujoco.MjModel,
        geoms: Array,
        speed: float,
        duration: float,
        keyframe: Keyframe,
    ) -> None:
        """Runs the scene, `speed` times as fast at the start."""
        self.deepest = self.farthest = 0.0
        self.native = 0
        self._model, self._geoms, self._keyframe = model, geoms, keyframe
        self._data = initial_data(model, keyframe=keyframe)
        self._data.qvel[:] *= speed
        self.pulses = PulseReader(model, self._data)
        watch = RunWatch(model, self._data)
        # an owned geom is seen from its gap and margin on
        sight = model.geom_gap[geoms] + model.geom_margin[geoms]
        self._sight = np.maximum(sight, 1e-300)
        steps = step_count(model, duration)
        check_recording(steps, 4 + model.nv)
        time, qvel, energy = [0.0], [self._data.qvel.copy()], []
        with collected_warnings() as messages:
            for _ in range(steps):
                energy.append(self._step())
                watch.after_step()
                time.append(time[-1] + float(model.opt.timestep))
                qvel.append(self._data.qvel.copy())
                if messages:
                    break
        self.warnings = tuple(messages)
        self.finite = bool(
            np.isfinite(self._data.qpos).all() and np.isfinite(self._data.qvel).all()
        )
        self.bits = (
            self._data.qpos.tobytes()
            + self._data.qvel.tobytes()
            + self._data.plugin_state.tobytes()
        )
        energies = np.array(energy)
        self.remarks = watch.remarks(np.array(time[:-1]), energies, self.pulses.impacts)
        self.outcome = Outcome(
            time=np.array(time),
            qvel=np.array(qvel),
            impacts=sorted(self.pulses.impacts, key=lambda impact: impact.time),
            count=len(self.pulses.impacts) + self.pulses.missed,
            energy=_change(energies),
        )

    def other_starts(self) -> str:
        """Returns the keyframes to start from instead, in words; "" if none is left."""
        names = [self._model.key(number).name for number in range(self._model.nkey)]
        keys = [
            name or str(number)
            for number, name in enumerate(names)
            if self._keyframe not in (number, name)
        ]
        more = ", ..." if len(keys) > NAMED else ""
        ways = " or ".join(f"--keyframe {key}" for key in keys[:NAMED])
        return f"; start with {ways}{more}" if keys else ""

    def _step(self) -> Array:
        """Takes a step and returns the energies of its start [J]."""
        data = self._data
        before = data.geom_xpos[self._geoms].copy()
        mujoco.mj_step(self._model, data)
        if data.time > 1.5 * self._model.opt.timestep:  # the first has no position yet
            way = np.linalg.norm(data.geom_xpos[self._geoms] - before, axis=1)
            self.farthest = max(self.farthest, float((way / self._sight).max()))
        if data.ncon:
            self._look_at_contacts(data)
        self.pulses.poll()
        return np.array(data.energy)

    def _look_at_contacts(self, data: mujoco.MjData) -> None:
        """Notes overlaps, and contacts that are MuJoCo's."""
        ours = np.isin(data.contact.geom, self._geoms).any(axis=1)
        if not ours.any():
            return
        self.deepest = max(self.deepest, float(-data.contact.dist[ours].min()))
        self.native += bool(np.any(data.contact.efc_address[ours] >= 0))


def problems_of(watch: WatchedRun, same_bits: bool) -> list[str]:
    """Returns what is wrong with a run, in words, each with its likely cause."""
    problems = [
        f"MuJoCo warns: {' '.join(text.split())}" for text in watch.warnings[:1]
    ]
    if not watch.finite:
        problems.append("the state is not finite")
    if not same_bits:
        problems.append("a second run ends in other bits")
    kinds = {remark.kind: remark.text for remark in watch.remarks}
    if not watch.outcome.count and not problems and not kinds.keys() & {FAST, PASSING}:
        problems.append(f"nothing struck: nothing can be said{watch.other_starts()}")
    problems += [kinds[kind] for kind in (ENERGY, PASSING) if kind in kinds]
    if FAST in kinds:
        problems.append(f"impacts may be missed: {kinds[FAST]}")
    # energy from nowhere makes bodies fast: then it is not the gap that is to blame
    if watch.farthest > 1 and not kinds.keys() & {ENERGY, FAST}:
        problems.append(
            f"a geom flies {watch.farthest:.3g} times the gap in one step: impacts "
            f"may be missed; attach(speed=...), or a smaller timestep"
        )
    impulses = [impact.impulse for impact in watch.pulses.impacts]
    if impulses and min(impulses) < 0:
        problems.append(f"a contact pulls: {min(impulses):.3g} N s")
    return problems


def _change(energies: Array) -> float:
    """Returns the change of energy over the largest kinetic energy; 0 at rest."""
    total, largest = energies.sum(axis=1), float(energies[:, 1].max())
    return float(total[-1] - total[0]) / largest if largest > 0 else 0.0
