"""A scene of the user's own, run in many ways: where does it stop being sound?"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.limits import check_recording
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.pulses import PulseReader
from mujoco_impact.remarks import ENERGY, FAST, PASSING
from mujoco_impact.runner import collected_warnings, initial_data, step_count
from mujoco_impact.scene import attach
from mujoco_impact.settings import Setting
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec, copy_spec
from mujoco_impact.starts import Keyframe, settled
from mujoco_impact.stress.case import INTEGRATORS
from mujoco_impact.stress.outcomes import Outcome, differences
from mujoco_impact.trajectory import Array
from mujoco_impact.verdict import RunWatch

TIMESTEPS = (0.1, 0.5, 2.0, 5.0)
"""Timesteps tried, over that of the scene."""

SPEEDS = (0.1, 3.0, 10.0)
"""Speeds at the start tried, over those of the scene."""

NAMED = 3
"""Keyframes that a message names."""

RESTITUTIONS = (1.0, 0.5, 0.0)
"""Coefficients of restitution tried, for a scene without the plugin."""


@dataclasses.dataclass(frozen=True)
class Variation:
    """One way of running a scene.

    Attributes:
        name: What is changed.
        timestep: Factor of the timestep.
        speed: Factor of the velocities at the start.
        integrator: Another integrator, None for that of the scene.
        settings: Settings of the impact law beside those of the user.
    """

    name: str
    timestep: float = 1.0
    speed: float = 1.0
    integrator: str | None = None
    settings: Mapping[str, Setting] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class Finding:
    """What one way of running a scene showed.

    Attributes:
        variation: Its name.
        impacts: Impacts of the plugin.
        missed: Impacts without a record, more than the state has slots.
        energy: Change of energy over the largest kinetic energy.
        deepest: Deepest overlap of owned geoms at the end of a step [m].
        farthest: Way of the fastest owned geom in a step, over the gap in which its
            contacts are seen: above 1 an impact may be missed.
        native: Steps in which MuJoCo's own contacts of owned geoms took part.
        same_bits: Whether a second run ended in the same bits.
        problems: What is wrong, in words; empty if nothing is.
        differences: Where it comes to something else than with the finest timestep.
    """

    variation: str
    impacts: int
    missed: int
    energy: float
    deepest: float
    farthest: float
    native: int
    same_bits: bool
    problems: tuple[str, ...]
    differences: tuple[str, ...] = ()


class StressInterrupted(KeyboardInterrupt):
    """A stress test was interrupted by hand (Ctrl-C).

    Attributes:
        findings: The findings until then.
    """

    def __init__(self, findings: list[Finding]) -> None:
        """Stores the findings."""
        super().__init__(f"interrupted after {len(findings)} runs")
        self.findings = findings


def stress_scene(
    source: Source,
    *,
    duration: float,
    keyframe: Keyframe = None,
    settings: Mapping[str, Setting] | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Finding]:
    """Runs a scene in many ways and looks for what goes wrong.

    Args:
        source: Path of a model file, XML text, or a specification (not changed).
        duration: Simulated time of each run [s].
        keyframe: See `run`.
        settings: Settings of the impact law by name, see `attach`; not for a scene
            that has the plugin already.
        progress: Called with the name of each variation as it begins.

    Returns:
        One finding per variation, the scene as it is first.

    Raises:
        SceneError: If the scene cannot take the plugin.
        ConfigError: If a setting is not valid.
        StressInterrupted: On Ctrl-C; it is a KeyboardInterrupt, and holds the findings
            until then.
    """
    spec = read_spec(source)
    if owned_geoms(spec) and settings:
        msg = "the scene has the plugin already: settings have no effect on it"
        raise SceneError(msg)
    keyframe = settled([key.name for key in spec.keys], keyframe)
    ways = variations(spec, keyframe)
    findings: list[Finding] = []
    outcomes: list[Outcome] = []
    try:
        for variation in ways:
            if progress is not None:
                progress(variation.name)
            varied = _varied(spec, variation, settings or {})
            finding, outcome = _find(varied, variation, duration, keyframe)
            findings.append(finding)
            outcomes.append(outcome)
    except KeyboardInterrupt:
        if not findings:
            raise
        kept = _compared(ways[: len(findings)], findings, outcomes)
        raise StressInterrupted(kept) from None
    return _compared(ways, findings, outcomes)


def _compared(
    ways: Sequence[Variation], findings: Sequence[Finding], outcomes: Sequence[Outcome]
) -> list[Finding]:
    """Returns the findings, those of other timesteps compared with the finest one."""
    finest = min(range(len(ways)), key=lambda index: ways[index].timestep)
    compared = []
    for way, finding, outcome in zip(ways, findings, outcomes, strict=True):
        only_timestep = way == Variation(way.name, timestep=way.timestep)
        if only_timestep and way != ways[finest]:
            told = differences(outcome, outcomes[finest], ways[finest].name)
            finding = dataclasses.replace(finding, differences=told)
        compared.append(finding)
    return compared


def variations(spec: mujoco.MjSpec, keyframe: Keyframe = None) -> tuple[Variation, ...]:
    """Returns the ways in which a scene is run."""
    start = initial_data(compile_spec(copy_spec(spec)), keyframe=keyframe)
    ways = [Variation("as it is")]
    ways += [Variation(f"timestep x {f:g}", timestep=f) for f in TIMESTEPS]
    ways += [Variation(f"integrator {name}", integrator=name) for name in INTEGRATORS]
    if start.qvel.any():
        ways += [Variation(f"speeds x {f:g}", speed=f) for f in SPEEDS]
    if not owned_geoms(spec):
        ways += [
            Variation(f"restitution {e:g}", settings={"restitution": e})
            for e in RESTITUTIONS
        ]
        ways += [Variation("pulses of 2 ms", settings={"duration": 2e-3})]
    return tuple(ways)


def _varied(
    spec: mujoco.MjSpec, variation: Variation, settings: Mapping[str, Setting]
) -> mujoco.MjSpec:
    """Returns the scene of a variation, with the plugin."""
    varied = copy_spec(spec)
    varied.option.timestep = spec.option.timestep * variation.timestep
    if variation.integrator is not None:
        varied.option.integrator = _INTEGRATORS[variation.integrator]
    if owned_geoms(varied):
        return varied
    law: dict[str, Any] = {**settings, **variation.settings}
    return attach(varied, **law)


def _find(
    spec: mujoco.MjSpec,
    variation: Variation,
    duration: float,
    keyframe: Keyframe,
) -> tuple[Finding, Outcome]:
    """Runs one variation twice and says what it showed, and came to."""
    owned = owned_geoms(spec)
    model = compile_spec(spec)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    names = [name for geoms in owned.values() for name in geoms or ()]
    geoms = np.array(
        [model.geom(name).id for name in names] or range(model.ngeom), dtype=int
    )
    first, second = (
        _Watch(model, geoms, variation, duration, keyframe) for _ in range(2)
    )
    same_bits = first.bits == second.bits
    finding = Finding(
        variation=variation.name,
        impacts=first.outcome.count,
        missed=first.pulses.missed,
        energy=first.outcome.energy,
        deepest=first.deepest,
        farthest=first.farthest,
        native=first.native,
        same_bits=same_bits,
        problems=tuple(_problems(first, same_bits)),
    )
    return finding, first.outcome


class _Watch:
    """One run of a scene and what was seen in it."""

    def __init__(
        self,
        model: mujoco.MjModel,
        geoms: Array,
        variation: Variation,
        duration: float,
        keyframe: Keyframe,
    ) -> None:
        """Runs the scene."""
        self.deepest = self.farthest = 0.0
        self.native = 0
        self._model, self._geoms, self._keyframe = model, geoms, keyframe
        self._data = initial_data(model, keyframe=keyframe)
        self._data.qvel[:] *= variation.speed
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


def _change(energies: Array) -> float:
    """Returns the change of energy over the largest kinetic energy; 0 at rest."""
    total, largest = energies.sum(axis=1), float(energies[:, 1].max())
    return float(total[-1] - total[0]) / largest if largest > 0 else 0.0


def _problems(watch: _Watch, same_bits: bool) -> list[str]:
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


_INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "discrete": mujoco.mjtIntegrator.mjINT_DISCRETE,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
}
