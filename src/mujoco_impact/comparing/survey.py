"""What is seen of a motion at its samples, whatever computed its contacts.

The scene without the plugin is put into every sampled state: where the bodies are and
how fast, what overlaps, and the energy. MuJoCo's contacts show as overlaps that begin
and end; ours show in their records, for they are over within a step.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable

import mujoco
import numpy as np

from mujoco_impact.impact_list import met
from mujoco_impact.pulses import geom_name
from mujoco_impact.trajectory import Array, Trajectory
from mujoco_impact.verdict.encounters import Flags, half_widths, meetings
from mujoco_impact.verdict.overlaps import THROUGH

HALF_STEP_INTEGRATORS = ("Euler", "implicit", "implicitfast", "discrete")
"""Integrators whose positions are half a step ahead of their velocities."""

LONGEST_CONTACT = 0.1
"""A contact that lasts longer has come to rest; what it loses then is no impact [s]."""

CROSSED = 0.9
"""Two spheres have flown through each other if they are apart at two samples, and the
way between them comes closer than this part of the sum of their radii: bodies that
collide stay outside of the plane in which they touch."""

MOST_SPHERES = 40
"""Spheres looked at for flying through each other: every pair of them is."""

Pair = tuple[int, int]


@dataclasses.dataclass(frozen=True)
class Touch:
    """One stretch of samples at which two geoms overlap.

    Attributes:
        pair: Ids of the two geoms.
        first: Number of the first sample that overlaps.
        last: Number of the last one.
        closing_speed: Speed along the normal at the sample before [m/s]; nan for one
            that overlaps from the start.
    """

    pair: Pair
    first: int
    last: int
    closing_speed: float


@dataclasses.dataclass(frozen=True, eq=False)
class Survey:
    """What was seen of one motion.

    Attributes:
        positions: Centres of mass of the bodies [m], shape (n_samples, nbody, 3).
        velocities: Their velocities [m/s], shape (n_samples, nbody, 3).
        energy: Potential and kinetic energy [J], shape (n_samples,); of integrators
            that put positions half a step ahead, both at the same time.
        touches: Overlaps in order of time.
        deepest: Deepest overlap at the samples [m].
        deepest_pair: Names of its two geoms; empty if nothing overlaps.
        passed: Names of pairs of geoms that passed through each other.
        impacts: How often two geoms met faster than a given speed.
        lost: Energy that impacts took [J]; negative: they added it.
    """

    positions: Array
    velocities: Array
    energy: Array
    touches: tuple[Touch, ...]
    deepest: float
    deepest_pair: tuple[str, ...]
    passed: tuple[tuple[str, str], ...]
    impacts: int
    lost: float


def survey(
    model: mujoco.MjModel, motion: Trajectory, *, ours: bool, slowest: float
) -> Survey:
    """Looks at every sample of a motion.

    Args:
        model: The scene without the plugin.
        motion: The motion.
        ours: Whether impacts are those of its records.
        slowest: Closing speed from which bodies that meet count as an impact [m/s].
    """
    seen = _Samples(model, motion)
    touches = _touches(seen)
    rest = rest_speed(model, motion)
    busy: Flags = np.zeros(len(motion.time), dtype=bool)
    if ours:
        found = met(motion.impacts, motion.timestep)
        speeds = [one.closing_speed for one in found]
        for one in found:
            busy[step_of(motion.time, one.time)] = True
    else:
        known = [one for one in touches if np.isfinite(one.closing_speed)]
        speeds = [one.closing_speed for one in known]
        most = max(1, round(LONGEST_CONTACT / float(motion.time[1] - motion.time[0])))
        struck = {one for one in known if one.closing_speed > rest}
        for begin, end in _stretches(model, known, struck, most):
            busy[begin:end] = True
    change = np.append(np.diff(seen.energy), 0.0)
    deepest, pair = seen.deepest
    return Survey(
        positions=seen.positions,
        velocities=seen.velocities,
        energy=seen.energy,
        touches=touches,
        deepest=deepest,
        deepest_pair=tuple(geom_name(model, geom) for geom in pair),
        passed=tuple(_passed(model, seen, motion)),
        impacts=sum(speed > slowest for speed in speeds),
        lost=-float(change[busy].sum()),
    )


class _Samples:
    """The states of a motion, looked at one after the other."""

    def __init__(self, model: mujoco.MjModel, motion: Trajectory) -> None:
        """Looks at all of them."""
        count = len(motion.time)
        self.model, self.count = model, count
        self.positions = np.zeros((count, model.nbody, 3))
        self.velocities = np.zeros((count, model.nbody, 3))
        self.geoms = np.zeros((count, model.ngeom, 3))
        self.energy = np.zeros(count)
        self.overlaps: list[dict[Pair, float]] = []
        self.closing: list[dict[Pair, float]] = []
        self._data = mujoco.MjData(model)
        self._early = mujoco.MjData(model)
        half = motion.integrator in HALF_STEP_INTEGRATORS
        self._shift = -0.5 * motion.timestep if half else 0.0
        for sample in range(count):
            self._look(sample, motion.qpos[sample], motion.qvel[sample])

    @property
    def deepest(self) -> tuple[float, Pair | tuple[()]]:
        """The deepest overlap [m] and its geoms."""
        found = [(depth, pair) for one in self.overlaps for pair, depth in one.items()]
        return max(found, default=(0.0, ()))

    def _look(self, sample: int, qpos: Array, qvel: Array) -> None:
        """Looks at one state; the cvel in the data are still those of the last."""
        model, data = self.model, self._data
        velocity, centre = data.cvel.copy(), data.subtree_com.copy()
        data.qpos[:], data.qvel[:] = qpos, qvel
        mujoco.mj_fwdPosition(model, data)
        overlaps: dict[Pair, float] = {}
        closing: dict[Pair, float] = {}
        geoms, depths = data.contact.geom, -data.contact.dist
        overlapping = np.flatnonzero((depths > 0.0) & (geoms.min(axis=1) >= 0))
        for index in overlapping.tolist() if data.ncon else ():
            first, second = geoms[index].tolist()
            pair = (first, second) if first < second else (second, first)
            overlaps[pair] = max(float(depths[index]), overlaps.get(pair, 0.0))
            if sample and pair not in self.overlaps[-1]:
                speed = _closing_speed(model, data.contact[index], velocity, centre)
                closing[pair] = max(speed, closing.get(pair, -np.inf))
        self.overlaps.append(overlaps)
        self.closing.append(closing)
        mujoco.mj_comVel(model, data)
        mujoco.mj_energyVel(model, data)
        self.positions[sample] = data.xipos
        self.geoms[sample] = data.geom_xpos
        roots = data.subtree_com[model.body_rootid]
        spin, linear = data.cvel[:, :3], data.cvel[:, 3:]
        self.velocities[sample] = linear + np.cross(spin, data.xipos - roots)
        self.energy[sample] = data.energy[1] + self._potential(qpos, qvel)

    def _potential(self, qpos: Array, qvel: Array) -> float:
        """Returns the potential energy at the time of the velocities [J]."""
        early = self._early
        early.qpos[:] = qpos
        if self._shift:
            mujoco.mj_integratePos(self.model, early.qpos, qvel, self._shift)
        mujoco.mj_kinematics(self.model, early)
        mujoco.mj_comPos(self.model, early)
        mujoco.mj_tendon(self.model, early)
        mujoco.mj_energyPos(self.model, early)
        return float(early.energy[0])


def _closing_speed(
    model: mujoco.MjModel, contact: mujoco.MjContact, cvel: Array, centre: Array
) -> float:
    """Returns the speed at which two geoms close, by the velocities of bodies [m/s]."""
    speeds = []
    for geom in contact.geom:
        body = int(model.geom_bodyid[geom])
        arm = contact.pos - centre[model.body_rootid[body]]
        speeds.append(cvel[body, 3:] + np.cross(cvel[body, :3], arm))
    return float(contact.frame[:3] @ (speeds[0] - speeds[1]))


def _touches(seen: _Samples) -> tuple[Touch, ...]:
    """Returns the stretches of samples at which pairs overlap."""
    found: list[Touch] = []
    begun: dict[Pair, int] = {}
    for sample, overlaps in enumerate([*seen.overlaps, {}]):
        for pair in [pair for pair in begun if pair not in overlaps]:
            first = begun.pop(pair)
            speed = seen.closing[first].get(pair, np.nan)
            found.append(Touch(pair, first, sample - 1, float(speed)))
        for pair in overlaps:
            begun.setdefault(pair, sample)
    return tuple(sorted(found, key=lambda one: one.first))


def _stretches(
    model: mujoco.MjModel, touches: Iterable[Touch], struck: set[Touch], most: int
) -> list[tuple[int, int]]:
    """Returns the stretches of steps in which impacts are under way.

    A contact hands on what it has stored to others of its bodies, so one stretch lasts
    until all of them are open again.

    Args:
        model: The scene.
        touches: Overlaps that began within the run, in order of time.
        struck: Those that began as impacts.
        most: Steps after which a contact is at rest.
    """
    groups: list[tuple[int, int, set[int], bool]] = []
    for one in touches:
        begin, end = one.first - 1, min(one.last + 1, one.first + most)
        bodies = {int(body) for body in model.geom_bodyid[list(one.pair)]}
        bodies = {body for body in bodies if model.body_weldid[body] != 0}
        hit = one in struck
        apart = []
        for group in groups:
            if group[1] >= begin and group[2] & bodies:
                begin, end = min(begin, group[0]), max(end, group[1])
                bodies, hit = bodies | group[2], hit or group[3]
            else:
                apart.append(group)
        groups = [*apart, (begin, end, bodies, hit)]
    return [(begin, end) for begin, end, _, hit in groups if hit]


def rest_speed(model: mujoco.MjModel, motion: Trajectory) -> float:
    """Returns the speed that gravity gives in two steps [m/s]: slower is rest."""
    return 2.0 * motion.timestep * float(np.linalg.norm(model.opt.gravity))


def step_of(time: Array, when: float) -> int:
    """Returns the number of the sample from which the step of a time starts."""
    return max(0, min(len(time) - 2, int(np.searchsorted(time, when, "right")) - 1))


def _passed(
    model: mujoco.MjModel, seen: _Samples, motion: Trajectory
) -> Iterable[tuple[str, str]]:
    """Returns the names of pairs that passed through each other."""
    widths = half_widths(model)
    deepest: dict[Pair, float] = {}
    for overlaps in seen.overlaps:
        for pair, depth in overlaps.items():
            deepest[pair] = max(depth, deepest.get(pair, 0.0))
    start = seen.overlaps[0]
    pairs = {
        pair
        for pair, depth in deepest.items()
        if depth - start.get(pair, 0.0) > THROUGH * _breadth(widths, pair)
    }
    pairs |= set(_crossed(model, seen, motion))
    for first, second in sorted(pairs):
        yield geom_name(model, first), geom_name(model, second)


def _breadth(widths: Array, pair: Pair) -> float:
    """Returns the sum of half-widths of two geoms [m]; a plane has none."""
    low, high = sorted(float(widths[geom]) for geom in pair)
    return 2.0 * low if np.isfinite(high) else low


def _crossed(
    model: mujoco.MjModel, seen: _Samples, motion: Trajectory
) -> Iterable[Pair]:
    """Returns pairs of spheres whose centres came too close between two samples."""
    spheres = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE)
    spheres = spheres[:MOST_SPHERES]
    if len(spheres) < 2 or len(motion.time) < 2:
        return
    meet = meetings(model, spheres)
    for row, other in itertools.combinations(range(len(spheres)), 2):
        first, second = int(spheres[row]), int(spheres[other])
        if not meet[row, second]:
            continue
        reach = float(model.geom_size[[first, second], 0].sum())
        between = seen.geoms[:, second] - seen.geoms[:, first]
        start, way = between[:-1], np.diff(between, axis=0)
        square = np.maximum(np.einsum("ij,ij->i", way, way), 1e-300)
        part = np.clip(-np.einsum("ij,ij->i", start, way) / square, 0.0, 1.0)
        nearest = np.linalg.norm(start + part[:, None] * way, axis=1)
        apart = np.linalg.norm(between, axis=1) >= reach
        if np.any(apart[:-1] & apart[1:] & (nearest < CROSSED * reach)):
            yield first, second
