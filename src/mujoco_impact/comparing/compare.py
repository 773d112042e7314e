"""One scene under our impacts, under MuJoCo's own contacts and in the Hertz reference.

`compare` returns a `Comparison`; its `table()` has one dictionary per method.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact import metrics
from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.baselines import Method, baselines
from mujoco_impact.comparing.first_impact import (
    find_first_impact,
    velocities_at,
    window_of,
)
from mujoco_impact.comparing.references import (
    ImpactReference,
    Material,
    impact_reference,
)
from mujoco_impact.comparing.survey import HALF_STEP_INTEGRATORS, rest_speed, survey
from mujoco_impact.comparison import OURS, Comparison, MethodResult
from mujoco_impact.errors import (
    ComparisonInterrupted,
    ConfigError,
    ImpactError,
    ImpactWarning,
    SceneError,
    SimulationError,
)
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.pendulums import PendulumRow, find_row
from mujoco_impact.pulses import geom_name
from mujoco_impact.reference import ReferenceTrajectory, swing
from mujoco_impact.runner import initial_data, load_model, run, step_count
from mujoco_impact.scene import attach, detach
from mujoco_impact.settings import (
    DEFAULT_POISSON,
    DEFAULT_YOUNG,
    Setting,
    attributes,
)
from mujoco_impact.source import Source, read_spec
from mujoco_impact.starts import Keyframe, keyframe_names, settled
from mujoco_impact.timing import interleaved_times
from mujoco_impact.trajectory import Array, Trajectory
from mujoco_impact.verdict import ALONE

__all__ = ["Comparison", "compare"]

INSTANCE = "impact"
"""Name of the plugin instance."""

MOST_REFERENCE_BALLS = 12
"""Longer rows are chaotic after the first wave, and their reference takes minutes."""

SMALLEST = 0.05
"""Of the fastest closing speed of our motion: slower meetings are not counted."""


def compare(
    source: Source,
    *,
    duration: float,
    keyframe: Keyframe = None,
    qpos: npt.ArrayLike | None = None,
    qvel: npt.ArrayLike | None = None,
    geoms: Iterable[str] | None = None,
    gap: float | None = None,
    depth: float | None = None,
    speed: float | None = None,
    repeats: int = 5,
    settings: Mapping[str, Setting] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Comparison:
    """Runs one scene under our impacts and under MuJoCo's own contacts.

    MuJoCo runs the scene as it is, and with the best settings known for touching balls
    (see `mujoco_impact.baselines`). Of each motion is told how fast the bodies of the
    first impact are before and after it, what energy impacts took, how deep bodies
    overlapped and which passed through each other. Where the truth is known without an
    engine, errors stand beside: a row of pendulum balls without losses, spheres without
    friction, a single contact. A scene that has the plugin keeps it as it is, with its
    settings; MuJoCo's contacts then take its place.

    Args:
        source: Path of a model file, XML text, or a specification (not changed).
        duration: Simulated time [s].
        keyframe: See `run`.
        qpos: Initial positions, shape (nq,), instead of those of the keyframe.
        qvel: Initial velocities, shape (nv,), instead of those of the keyframe.
        geoms: See `attach`.
        gap: See `attach`.
        depth: See `attach`.
        speed: See `attach`.
        repeats: How often each method is timed, in turn with the others.
        settings: Settings of the impact law by name, see `attach`; like all that
            `attach` takes, not for a scene that has the plugin already.
        progress: Called with the name of each stage as it begins.

    Raises:
        SceneError: If the scene cannot take the plugin.
        ConfigError: If a setting is not valid, or has no effect on the scene.
        SimulationError: If our own run fails; a failure of MuJoCo's contacts is a
            result.
        ComparisonInterrupted: On Ctrl-C, once our own run is over; it is a
            KeyboardInterrupt, and holds the results until then.
    """
    report = progress or (lambda _: None)
    attributes(dict(settings or {}))
    report(OURS)
    options = {"geoms": geoms, "gap": gap, "depth": depth, "speed": speed}
    attached, law = _ours(read_spec(source), options, dict(settings or {}))
    plain = detach(attached)
    given = qpos is not None or qvel is not None
    number = settled([key.name for key in plain.keys], keyframe, given=given)
    start: dict[str, Any] = {"keyframe": number, "qpos": qpos, "qvel": qvel}
    ours = Method(OURS, _shown(law), attached)
    motion = run(attached, duration=duration, **start)
    judge = _Judge(attached, plain, motion, law)
    report("reference")
    judge.find_references()
    speed, restitution = judge.speed, judge.material.restitution
    methods = (ours, *baselines(plain, impact_speed=speed, restitution=restitution))
    results: list[MethodResult] = []
    try:
        for method in methods:
            report(method.name)
            known = motion if method is ours else None
            results.append(_run_method(method, duration, start, judge, known))
        report("run times")
        timed = _with_run_times(methods, results, duration, start, repeats)
    except KeyboardInterrupt:
        if not results:
            raise
        raise ComparisonInterrupted(judge.comparison(duration, results)) from None
    return judge.comparison(duration, timed)


def _ours(
    spec: mujoco.MjSpec, options: dict[str, Any], settings: dict[str, Any]
) -> tuple[mujoco.MjSpec, dict[str, Any]]:
    """Returns the scene with the plugin, and the settings that hold in it.

    Args:
        spec: The scene; one that has the plugin stays as it is.
        options: What else `attach` takes, None for its defaults.
        settings: Settings of the impact law by name.
    """
    instances = [one for one in spec.plugins if one.plugin_name == PLUGIN_NAME]
    if not instances:
        return attach(spec, name=INSTANCE, **options, **settings), settings
    given = [name for name, value in options.items() if value is not None]
    given += settings
    if given:
        msg = (
            f"{', '.join(given)}: no effect, for the scene has the plugin already: set "
            "it there, or take the plugin out (detach)"
        )
        raise ConfigError(msg)
    configs = [dict(one.config) for one in instances]
    if any(config != configs[0] for config in configs):
        return spec, {"law": "several instances, each with its own"}
    return spec, configs[0]


def _names_of(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Returns the names of the owned geoms of all instances."""
    owned = owned_geoms(spec).values()
    everything = tuple(geom.name for geom in spec.geoms)
    return tuple(
        name for names in owned for name in (everything if names is None else names)
    )


class _Judge:
    """What all methods of a scene are measured against: our motion, and references."""

    def __init__(
        self,
        attached: mujoco.MjSpec,
        plain: mujoco.MjSpec,
        motion: Trajectory,
        law: dict[str, Any],
    ) -> None:
        """Looks at our motion.

        Args:
            attached: The scene with the plugin.
            plain: The scene without it.
            motion: Our motion.
            law: Settings of the impact law.

        Raises:
            SceneError: If there is no impact in it.
        """
        self.model = load_model(attached)
        self._plain, self._names = load_model(plain), _names_of(attached)
        self._scene, self._motion = plain.modelname, motion
        self.material = Material(
            restitution=_number_setting(law, "restitution", 1.0),
            young=_number_setting(law, "young", DEFAULT_YOUNG),
            poisson=_number_setting(law, "poisson", DEFAULT_POISSON),
            friction=law.get("friction", "none") != "none",
            hertz=law.get("law", "hertz") == "hertz",
        )
        fastest = max((one.closing_speed for one in motion.impacts), default=0.0)
        rest = rest_speed(self._plain, motion)
        self._slowest = max(rest, SMALLEST * fastest)
        self.ours = survey(self._plain, motion, ours=True, slowest=self._slowest)
        geoms = {geom_name(self.model, geom): geom for geom in range(self.model.ngeom)}
        first = find_first_impact(self._plain, motion, geoms)
        if first is None:
            raise SceneError(_nothing_told(self._plain, motion))
        self.first = first
        self.row: PendulumRow | None = None
        self.reference: ReferenceTrajectory | None = None
        self._impact: ImpactReference | None = None
        self._row_velocities: tuple[float, ...] | None = None
        self._row_speed, self._note = 0.0, ""

    @property
    def speed(self) -> float:
        """Closing speed of the first impact [m/s]."""
        return self._row_speed or self.first.closing_speed

    def find_references(self) -> None:
        """Finds what is known of the scene without an engine."""
        self._find_row()
        if self.reference is None and self.row is None:
            self._impact, self._note = impact_reference(
                self._plain, self._motion, self.ours, self.first, self.material
            )

    def _find_row(self) -> None:
        """Finds the Hertz reference of a row of pendulums, or why there is none."""
        material = self.material
        self.row = row = find_row(
            self.model, young=material.young, poisson=material.poisson
        )
        if row is None:
            return
        if row.chain.count > MOST_REFERENCE_BALLS:
            self._note = f"no Hertz reference: more than {MOST_REFERENCE_BALLS} balls"
            return
        if material.restitution != 1.0 or not material.hertz:
            self._note = "no Hertz reference: it is elastic, the law is not"
            return
        motion, time = self._motion, self._motion.time
        start = row.angles(motion.qpos[0]), row.angles(motion.qvel[0])
        try:
            reference = swing(row.chain, *start, float(time[-1]))
            samples = reference(time)
            left = metrics.velocity_after_first_impact(time, *samples, row.chain)
        except ImpactError as error:
            self._note = f"no Hertz reference: {error}"
            return
        onset = reference.contact_intervals[:1, 0]
        fastest = float(np.abs(reference(onset)[1]).max())
        self.reference, self._row_velocities = reference, tuple(left.tolist())
        self._row_speed = fastest * row.chain.length

    def measured(self, result: MethodResult) -> MethodResult:
        """Returns a result with what is measured of its motion."""
        motion = result.trajectory
        if motion is None:
            return result
        ours = motion is self._motion
        seen = self.ours
        if not ours:
            seen = survey(self._plain, motion, ours=False, slowest=self._slowest)
        result = self._with_speeds(dataclasses.replace(result, seen=seen), motion, ours)
        if self.row is None or self.reference is None:
            return result
        samples = row_samples(self.row, motion)
        left = metrics.velocity_after_first_impact(*samples, self.row.chain)
        return dataclasses.replace(
            result,
            first_velocities=tuple(left.tolist()),
            errors=metrics.row_errors(*samples, self.reference),
        )

    def _with_speeds(
        self, result: MethodResult, motion: Trajectory, ours: bool
    ) -> MethodResult:
        """Returns a result with the velocities before and after the first impact."""
        first, seen = self.first, result.seen
        if seen is None:
            return result
        window = (
            (first.before, first.after)
            if ours
            else window_of(self._plain, first, motion, seen)
        )
        if window is None:
            return result
        known = self._impact
        still = np.zeros((len(first.bodies), 3))
        free = still if known is None else known.free
        before, after = (
            velocities_at(motion, seen, sample, first.bodies, free) for sample in window
        )
        result = dataclasses.replace(result, before=before, after=after)
        if known is None:
            return result
        wrong = after - known.at(float(motion.time[window[1]]))
        error = float(np.sqrt(np.mean(np.sum(wrong**2, axis=1)))) / self.speed
        return dataclasses.replace(result, first_error=error)

    def comparison(
        self, duration: float, results: Sequence[MethodResult]
    ) -> Comparison:
        """Returns the outcome."""
        bodies = tuple(
            self._plain.body(body).name or f"body {body}" for body in self.first.bodies
        )
        return Comparison(
            scene=self._scene,
            start=self._motion.start,
            duration=duration,
            timestep=self._motion.timestep,
            integrator=self._motion.integrator,
            mujoco_version=self._motion.mujoco_version,
            impact_speed=self.speed,
            model=self.model,
            geoms=self._names,
            methods=tuple(results),
            first=self.first,
            bodies=bodies,
            slowest=self._slowest,
            row=self.row,
            reference=self.reference,
            reference_velocities=self._row_velocities,
            impact_reference=self._impact,
            note=self._note,
        )


def _run_method(
    method: Method,
    duration: float,
    start: dict[str, Any],
    judge: _Judge,
    known: Trajectory | None,
) -> MethodResult:
    """Runs one method, unless its motion is known, and measures it."""
    try:
        with warnings.catch_warnings():
            # what MuJoCo's own contacts do wrong stands in the table
            warnings.simplefilter("ignore", ImpactWarning)
            motion = known or run(
                method.spec, duration=duration, every=method.every, **start
            )
    except SimulationError as error:
        return MethodResult(method.name, method.setting, None, failure=str(error))
    return judge.measured(MethodResult(method.name, method.setting, motion))


def row_samples(row: PendulumRow, motion: Trajectory) -> tuple[Array, Array, Array]:
    """Returns times, angles and velocities of a row, as exact as they can be read.

    MuJoCo's semi-implicit steps shift the motion of a row that starts at rest by half
    a step; that is no error of the impacts and is taken out.
    """
    angles, velocities = row.angles(motion.qpos), row.angles(motion.qvel)
    if motion.integrator not in HALF_STEP_INTEGRATORS or velocities[0].any():
        return motion.time, angles, velocities
    return metrics.euler_half_step(
        motion.time, angles, velocities, row.chain, timestep=motion.timestep
    )


def _with_run_times(
    methods: Sequence[Method],
    results: Sequence[MethodResult],
    duration: float,
    start: dict[str, Any],
    repeats: int,
) -> tuple[MethodResult, ...]:
    """Adds run times to the results of the methods that did not fail."""
    alive = [index for index, result in enumerate(results) if not result.failure]
    models = [load_model(methods[index].spec) for index in alive]
    starts = [initial_data(model, **start) for model in models]
    steps = [step_count(model, duration) for model in models]
    times = interleaved_times(models, starts, steps, repeats=repeats) / duration
    # the second method is the scene as it is
    base = times[:, alive.index(1)] if 1 in alive else np.full(len(times), np.nan)
    timed = list(results)
    for column, index in enumerate(alive):
        timed[index] = dataclasses.replace(
            results[index],
            run_time=float(np.median(times[:, column])),
            cost=float(np.median(times[:, column] / base)),
        )
    return tuple(timed)


def _nothing_told(model: mujoco.MjModel, motion: Trajectory) -> str:
    """Returns what is said of a scene without an impact."""
    if any(remark.text == ALONE for remark in motion.remarks):
        return ALONE
    names = [name or str(number) for number, name in enumerate(keyframe_names(model))]
    others = f" ({', '.join(names)})" if names else ""
    return (
        f"there is no impact within {motion.time[-1]:g} s from {motion.start}, so "
        f"there is nothing to compare: run longer, or start from another keyframe"
        f"{others} or state"
    )


def _number_setting(settings: dict[str, Any], name: str, usual: float) -> float:
    """Returns a setting that is one number; `attach` has checked that it is."""
    return float(settings.get(name, usual))


def _shown(settings: dict[str, Any]) -> str:
    """Returns the settings as they are called."""
    return ", ".join(f"{key}={value}" for key, value in settings.items()) or "defaults"
