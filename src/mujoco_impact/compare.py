"""One scene under our impacts, under MuJoCo's own contacts and in the Hertz reference.

`compare` returns a `Comparison`; its `table()` has one dictionary per method.
"""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact import metrics
from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.baselines import Method, baselines
from mujoco_impact.comparison import OURS, Comparison, MethodResult
from mujoco_impact.errors import (
    ConfigError,
    ImpactError,
    ImpactWarning,
    SceneError,
    SimulationError,
)
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.pendulums import PendulumRow, find_row
from mujoco_impact.reference import ReferenceTrajectory, swing
from mujoco_impact.runner import initial_data, load_model, run, step_count
from mujoco_impact.scene import attach, detach
from mujoco_impact.settings import Setting, attributes
from mujoco_impact.source import Source, read_spec
from mujoco_impact.starts import Keyframe, settled
from mujoco_impact.timing import interleaved_times
from mujoco_impact.trajectory import Array, Trajectory

__all__ = ["Comparison", "compare"]

INSTANCE = "impact"
"""Name of the plugin instance."""

MOST_REFERENCE_BALLS = 12
"""Longer rows are chaotic after the first wave, and their reference takes minutes."""

HALF_STEP_INTEGRATORS = ("Euler", "implicit", "implicitfast", "discrete")
"""Integrators whose motion from rest is half a step ahead, see `row_samples`."""


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
    (see `mujoco_impact.baselines`). If the scene is a row of pendulum balls without
    losses, the Hertz reference tells how wrong each of them is. A scene that has the
    plugin keeps it as it is, with its settings; MuJoCo's contacts then take its place.

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
    model = load_model(attached)
    report("Hertz reference")
    truth = _reference(model, motion, law)
    speed = truth.speed or _first_closing_speed(model, motion)
    restitution = _number_setting(law, "restitution", 1.0)
    methods = (ours, *baselines(plain, impact_speed=speed, restitution=restitution))
    results = []
    for method in methods:
        report(method.name)
        known = motion if method is ours else None
        results.append(_run_method(method, duration, start, truth, known))
    report("run times")
    timed = _with_run_times(methods, results, duration, start, repeats)
    return Comparison(
        scene=plain.modelname,
        duration=duration,
        timestep=motion.timestep,
        integrator=motion.integrator,
        mujoco_version=motion.mujoco_version,
        impact_speed=speed,
        model=model,
        geoms=_names_of(attached),
        methods=timed,
        row=truth.row,
        reference=truth.motion,
        reference_velocities=truth.velocities,
        note=truth.note,
    )


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


@dataclasses.dataclass(frozen=True, eq=False)
class _Truth:
    """The Hertz reference of a scene, or why there is none."""

    row: PendulumRow | None = None
    motion: ReferenceTrajectory | None = None
    velocities: tuple[float, ...] | None = None
    speed: float = 0.0
    note: str = ""


def _reference(
    model: mujoco.MjModel, motion: Trajectory, settings: dict[str, Any]
) -> _Truth:
    """Returns the Hertz reference from the initial state of a motion."""
    row = find_row(
        model,
        young=_number_setting(settings, "young", 2e11),
        poisson=_number_setting(settings, "poisson", 0.3),
    )
    if row is None:
        return _Truth(note="no Hertz reference: not a row of pendulum balls")
    if row.chain.count > MOST_REFERENCE_BALLS:
        note = f"no Hertz reference: more than {MOST_REFERENCE_BALLS} balls"
        return _Truth(row, note=note)
    elastic = _number_setting(settings, "restitution", 1.0) == 1.0
    if not elastic or settings.get("law", "hertz") != "hertz":
        return _Truth(row, note="no Hertz reference: it is elastic, the law is not")
    angles, velocities = row.angles(motion.qpos[0]), row.angles(motion.qvel[0])
    try:
        reference = swing(row.chain, angles, velocities, float(motion.time[-1]))
        time = motion.time
        left = metrics.velocity_after_first_impact(time, *reference(time), row.chain)
    except ImpactError as error:
        return _Truth(row, note=f"no Hertz reference: {error}")
    onset = reference.contact_intervals[:1, 0]
    speed = float(np.abs(reference(onset)[1]).max()) * row.chain.length
    return _Truth(row, reference, tuple(left.tolist()), speed)


def _run_method(
    method: Method,
    duration: float,
    start: dict[str, Any],
    truth: _Truth,
    known: Trajectory | None,
) -> MethodResult:
    """Runs one method, unless its motion is known, and measures its errors."""
    try:
        with warnings.catch_warnings():
            # what MuJoCo's own contacts do wrong stands in the table
            warnings.simplefilter("ignore", ImpactWarning)
            motion = known or run(
                method.spec, duration=duration, every=method.every, **start
            )
    except SimulationError as error:
        return MethodResult(method.name, method.setting, None, failure=str(error))
    result = MethodResult(
        method.name, method.setting, motion, energy_drift=_energy_drift(motion)
    )
    if truth.row is None:
        return result
    samples = row_samples(truth.row, motion)
    drift = metrics.energy_drift(samples[1], samples[2], truth.row.chain)
    result = dataclasses.replace(result, energy_drift=drift)
    if truth.motion is None:
        return result
    left = metrics.velocity_after_first_impact(*samples, truth.row.chain)
    return dataclasses.replace(
        result,
        first_velocities=tuple(left.tolist()),
        errors=metrics.row_errors(*samples, truth.motion),
    )


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


def _energy_drift(motion: Trajectory) -> float:
    """Returns the change of energy over a run, over the largest kinetic energy."""
    largest = float(motion.energy[:, 1].max())
    total = motion.total_energy
    return float(total[-1] - total[0]) / largest if largest > 0 else math.nan


def _first_closing_speed(model: mujoco.MjModel, motion: Trajectory) -> float:
    """Returns the relative speed of the geoms of the first impact, before it [m/s]."""
    if not motion.impacts:
        msg = (
            f"there is no impact within {motion.time[-1]:g} s, so there is nothing to "
            "compare: run longer, or start from another state (keyframe)"
        )
        raise SceneError(msg)
    first = motion.impacts[0]
    sample = max(0, int(np.searchsorted(motion.time, first.time)) - 1)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = motion.qpos[sample], motion.qvel[sample]
    mujoco.mj_forward(model, data)
    velocities = np.zeros((2, 6))
    for name, velocity in zip(first.geoms, velocities, strict=True):
        geom = _geom_number(model, name)
        kind = mujoco.mjtObj.mjOBJ_GEOM
        mujoco.mj_objectVelocity(model, data, kind, geom, velocity, 0)
    return float(np.linalg.norm(velocities[1, 3:] - velocities[0, 3:]))


def _geom_number(model: mujoco.MjModel, name: str) -> int:
    """Returns the id of a geom as `Impact` calls it."""
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name)
    return number if number >= 0 else int(name.rpartition(" ")[2])


def _number_setting(settings: dict[str, Any], name: str, usual: float) -> float:
    """Returns a setting that is one number; `attach` has checked that it is."""
    return float(settings.get(name, usual))


def _shown(settings: dict[str, Any]) -> str:
    """Returns the settings as they are called."""
    return ", ".join(f"{key}={value}" for key, value in settings.items()) or "defaults"
