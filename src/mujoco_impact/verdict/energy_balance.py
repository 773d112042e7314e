"""Whether the energy of a run grew beyond what forces did.

The energy that MuJoCo counts, E = potential + kinetic, may change by the work of
actuators and applied forces, and may always shrink. The mass of mocap bodies is left
out of E: they are moved by hand. What they give to bodies that they strike is the
user's work, which nothing tells, so a run in which one of them moves is not judged.
Work is counted where it is positive only, so that what a force takes out and gives back
later never makes an alarm:

    growth(t) = E(t) - E(0) - sum of max(0, h (v + v')/2 . f)

v and v' the velocities before and after a step of h, f a generalized force.
Semi-implicit steps keep E shifted by (h/2) v . f, f the conservative forces; that much
is allowed.
"""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.pulses import plugin_instances
from mujoco_impact.remarks import ENERGY, Remark
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict.encounters import Flags
from mujoco_impact.verdict.free_flight import FreeRotation
from mujoco_impact.verdict.step_log import StepLog

GROWTH = 1e-2
"""Growth that is a problem, over the largest kinetic energy and all work done."""

ROUNDING = 1e-9
"""The same over the largest potential energy: a scene at rest has no kinetic one."""

TOUCHING = 1e-9
"""Violation of a constraint at the start that is none [m, rad]."""


class _Books:
    """Sums up to each sample: five numbers, see `add`."""

    def __init__(self, every: int) -> None:
        """Starts with nothing; a sample is taken after each `every` steps."""
        self._every, self._steps = every, 0
        self._last = np.zeros(5)
        self._samples = [np.zeros((1, 5))]

    def add(
        self, given: Array, impacts: Array, held: Array, flight: Array, power: Array
    ) -> None:
        """Adds what single steps brought.

        Args:
            given: Work of actuators and of what acts from outside, where it is positive
                [J], shape (steps,).
            impacts: Work of the plugin [J], shape (steps,).
            held: Work of MuJoCo's contacts, limits and ties [J], shape (steps,).
            flight: What Euler adds to free rotations [J], shape (steps,).
            power: Power of gravity and springs [W], shape (steps,); the largest is
                kept, not the sum.
        """
        sums = np.cumsum([given, impacts, held, flight], axis=1)
        rows = np.column_stack([*sums, np.maximum.accumulate(power)])
        rows[:, :_POWER] += self._last[:_POWER]
        rows[:, _POWER] = np.maximum(rows[:, _POWER], self._last[_POWER])
        ends = np.arange(self._steps + 1, self._steps + 1 + len(rows))
        self._samples.append(rows[ends % self._every == 0])
        self._steps += len(rows)
        self._last = rows[-1]

    def samples(self) -> Array:
        """Returns the sums at the samples, shape (n, 5), in the order of `add`."""
        self._samples = [np.concatenate(self._samples)]
        return self._samples[0]


@dataclasses.dataclass(frozen=True)
class Growth:
    """Energy that came from nowhere.

    Attributes:
        part: Of the largest kinetic energy, at the worst sample.
        since: Number of the first sample that has too much.
        cause: The likely cause, and the cure.
    """

    part: float
    since: int
    cause: str

    def remark(self) -> Remark:
        """Returns what to say about it."""
        text = (
            f"energy grew by {_percent(self.part)} of the largest kinetic energy, "
            f"beyond the work of forces; likely cause: {self.cause}"
        )
        return Remark(ENERGY, text)


class EnergyBalance:
    """Keeps the books of one run.

    Attributes:
        needs: What of `mjData` must be logged after each step.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        every: int = 1,
        controlled: bool = False,
    ) -> None:
        """Starts at the state of `data`.

        Args:
            model: The model.
            data: The data that is stepped.
            every: Steps between two samples of the energies.
            controlled: Whether a controller may change state and applied forces.
        """
        self._model, self._data = model, data
        ours = plugin_instances(model)
        # energies of flexes and other plugins are not in MuJoCo's sum
        self._judged = model.nflex == 0 and model.nplugin == len(ours)
        # moving surfaces push, and constraints that start violated have energy to give
        self._pushed = bool(model.flg_surfacevel)
        # what they give in impacts, by friction, is in no force that is logged
        self._judged = self._judged and not (self._pushed and ours)
        self._mocap = ("mocap_pos", "mocap_quat") if model.nmocap else ()
        self._poses = {name: getattr(data, name).copy() for name in self._mocap}
        self._first = True
        springs = _any(model, "jnt_stiffness", "tendon_stiffness")
        dampers = _any(model, "dof_damping", "tendon_damping")
        fluid = bool(model.opt.density or model.opt.viscosity)
        passive = {
            "qfrc_spring": springs,
            "qfrc_damper": dampers,
            "qfrc_fluid": fluid,
            "qfrc_gravcomp": model.ngravcomp > 0,
        }
        self._passive = [name for name, present in passive.items() if present]
        outside = {"qfrc_actuator": model.nu > 0, **passive}
        self._outside = [
            name
            for name in ("qfrc_actuator", "qfrc_fluid", "qfrc_gravcomp")
            if outside[name]
        ]
        self._plugin = ["qfrc_passive"] if ours else []
        self.needs = (
            *("qfrc_bias", "qfrc_constraint"),
            *{*self._passive, *self._outside, *self._plugin},
            *self._mocap,
        )
        self._rotation = FreeRotation(model)
        self._is_euler = model.opt.integrator == _EULER
        self._controlled = controlled
        self._applied: list[float] = []
        self._state: Array = np.concatenate([data.qpos, data.qvel])
        self._books = _Books(every)

    def after_controller(self) -> None:
        """Notes whether the state was changed from outside: that has no balance."""
        same = np.array_equal(self._state, _state(self._data))
        self._judged = self._judged and same

    def after_step(self) -> None:
        """Notes what is not logged."""
        if self._first:
            self._pushed = self._pushed or _is_violated(self._data)
            # Runge-Kutta leaves the forces of its last stage: their work is not known
            varying = self._pushed or self._outside
            runge_kutta = self._model.opt.integrator == _RK4
            self._judged = self._judged and not (runge_kutta and varying)
            self._first = False
        if not self._controlled:
            return
        before = self._state[self._model.nq :]
        way = 0.5 * float(self._model.opt.timestep) * (before + self._data.qvel)
        force = self._data.qfrc_applied + _generalized(self._model, self._data)
        self._applied.append(float(way @ force))
        self._state = _state(self._data)

    def count(self, log: StepLog) -> None:
        """Counts the work of the logged steps."""
        for name in self._mocap:
            if np.any(log[name] != self._poses[name]):
                self._judged = False
        before, after = log.before("qvel"), log["qvel"]
        way = 0.5 * float(self._model.opt.timestep) * (before + after)
        given = [_work(way, log[name]) for name in self._outside]
        if self._controlled:
            given.append(np.array(self._applied))
            self._applied.clear()
        held = _work(way, log["qfrc_constraint"])
        if self._pushed:
            given.append(held)
        none = np.zeros(log.count)
        impacts = none
        if self._plugin:
            # all passive forces but those of MuJoCo
            known = sum((log[name] for name in self._passive), np.zeros_like(way))
            impacts = _work(way, log["qfrc_passive"] - known)
        conservative = -log["qfrc_bias"]
        if "qfrc_spring" in self._passive:
            conservative = conservative + log["qfrc_spring"]
        self._books.add(
            given=sum((np.maximum(0.0, work) for work in given), none),
            impacts=impacts,
            held=held,
            flight=self._rotation.gain(before) if self._is_euler else none,
            power=np.maximum(
                *(np.abs(_work(velocity, conservative)) for velocity in (before, after))
            ),
        )

    def growth(self, energy: Array, quiet: Flags) -> Growth | None:
        """Returns the growth beyond what is allowed, and its likely cause.

        Args:
            energy: Potential and kinetic energy of the samples [J], shape (n, 2).
            quiet: Samples at which no pulse is under way, shape (n,): only there the
                impacts have done all that they do.

        Returns:
            None if energy did not grow, or if nothing can be said.
        """
        books = self._books.samples()
        count = min(len(energy), len(books))
        if not self._judged or count < 2:
            return None
        sound = np.isfinite(energy[:count]).all(axis=1)
        count = count if sound.all() else int(np.argmin(sound))
        growth, allowed = self._growth(energy[:count], books[:count])
        above = np.where(quiet[:count], growth - allowed, -np.inf)
        if not above.size or above.max() <= 0.0:
            return None
        worst = int(np.argmax(above))
        scale = max(float(energy[: worst + 1, 1].max()), 1e-300)
        most = float(growth[worst])
        since = int(np.argmax(above > 0.0))
        return Growth(most / scale, since, self._cause(books[worst], most))

    def _growth(self, energy: Array, books: Array) -> tuple[Array, Array]:
        """Returns growth and what of it is allowed in each sample [J], shape (n,)."""
        total = energy.sum(axis=1)
        given, power = books[:, _GIVEN], books[:, _POWER]
        # running: what comes later excuses nothing
        kinetic = np.maximum.accumulate(energy[:, 1])
        potential = np.maximum.accumulate(np.abs(energy[:, 0]))
        shift = float(self._model.opt.timestep) * power
        allowed = GROWTH * (kinetic + given) + shift + ROUNDING * potential
        return total - total[:1] - given, allowed

    def _cause(self, books: Array, growth: float) -> str:
        """Returns the likely cause of a growth [J], by the books, and the cure."""
        held = 0.0 if self._pushed else max(0.0, float(books[_HELD]))
        impacts = max(0.0, float(books[_IMPACTS]))
        rest = growth - held - impacts
        if held > max(impacts, rest):
            return (
                "MuJoCo's own contacts, limits or ties pushed bodies that were deep in "
                "each other; cure: a smaller timestep, attach(..., speed=) for the "
                "fastest body"
            )
        if impacts > rest:
            return (
                'the impacts added it; cure: passive="true" if it is switched off, a '
                "smaller timestep"
            )
        # half of it, for a tumbling body is not all that Euler drives up
        tumbles = self._is_euler and self._rotation.names
        if tumbles and (books[_FLIGHT] > rest / 2 or not self._rotation.known):
            return self._rotation.cause()
        return (
            "the integrator at a timestep of "
            f"{float(self._model.opt.timestep):g} s; cure: a smaller timestep"
        )


_GIVEN, _IMPACTS, _HELD, _FLIGHT, _POWER = range(5)
_EULER = int(mujoco.mjtIntegrator.mjINT_EULER)
_RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)


def _percent(part: float) -> str:
    """Returns a part as percent, to three digits: 0.021 is "2.1 %"."""
    percent = float(f"{100.0 * part:.3g}")
    return f"{percent:g} %" if percent < 1e6 else f"{percent:.2e} %"


def _work(way: Array, force: Array) -> Array:
    """Returns the work of generalized forces in each step [J], shape (steps,)."""
    work: Array = np.einsum("kj,kj->k", way, force)
    return work


def _any(model: mujoco.MjModel, *names: str) -> bool:
    """Returns whether a coefficient of the model, or of its higher orders, is set."""
    coefficients = (
        getattr(model, name + end) for name in names for end in ("", "poly")
    )
    return any(bool(numbers.any()) for numbers in coefficients)


def _state(data: mujoco.MjData) -> Array:
    """Returns positions and velocities, shape (nq + nv,)."""
    state: Array = np.concatenate([data.qpos, data.qvel])
    return state


def _is_violated(data: mujoco.MjData) -> bool:
    """Returns whether a constraint starts violated: it then has energy to give."""
    return bool(data.nefc) and bool(np.any(data.efc_pos < data.efc_margin - TOUCHING))


def _generalized(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Returns the generalized force of the forces applied to bodies, shape (nv,)."""
    result = np.zeros(model.nv)
    for body in np.flatnonzero(data.xfrc_applied.any(axis=1)):
        force = data.xfrc_applied[body]
        point = data.xipos[body]
        mujoco.mj_applyFT(model, data, force[:3], force[3:], point, int(body), result)
    return result
