"""One scene under our impacts, under MuJoCo's own contacts and in the Hertz reference.

`compare` returns a `Comparison`; its `table()` has one dictionary per method.
"""

from __future__ import annotations

import dataclasses
import time
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.baselines import Method, baselines
from mujoco_impact.comparing.judge import Judge
from mujoco_impact.comparison import OURS, Comparison, MethodResult
from mujoco_impact.errors import (
    ComparisonInterrupted,
    ConfigError,
    ImpactWarning,
    SimulationError,
)
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.runner import initial_data, load_model, run, step_count
from mujoco_impact.scene import attach, detach
from mujoco_impact.settings import Setting, attributes
from mujoco_impact.source import Source, read_spec
from mujoco_impact.starts import Keyframe, settled
from mujoco_impact.trajectory import Array, Trajectory

__all__ = ["Comparison", "compare"]

INSTANCE = "impact"
"""Name of the plugin instance."""


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
    judge = Judge(attached, plain, motion, law)
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


def _run_method(
    method: Method,
    duration: float,
    start: dict[str, Any],
    judge: Judge,
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


def _shown(settings: dict[str, Any]) -> str:
    """Returns the settings as they are called."""
    return ", ".join(f"{key}={value}" for key, value in settings.items()) or "defaults"


def interleaved_times(
    models: Sequence[mujoco.MjModel],
    starts: Sequence[mujoco.MjData],
    steps: Sequence[int],
    *,
    repeats: int,
) -> Array:
    """Times simulations in turn, so that all of them see the same load of the machine.

    Each is stepped by one call into MuJoCo, without Python in between, from its initial
    state.

    Args:
        models: The models.
        starts: Initial state of each; not changed.
        steps: Number of steps of each.
        repeats: Number of rounds; one more, which is not counted, warms up.

    Returns:
        Wall-clock times [s], shape (repeats, len(models)).
    """
    if repeats < 1:
        msg = f"repeats = {repeats}: must be >= 1"
        raise ValueError(msg)
    work = [mujoco.MjData(model) for model in models]
    times = np.zeros((repeats + 1, len(models)))
    with collected_warnings():
        for turn in range(repeats + 1):
            for index, model in enumerate(models):
                mujoco.mj_copyData(work[index], model, starts[index])
                begin = time.perf_counter()
                mujoco.mj_step(model, work[index], nstep=steps[index])
                times[turn, index] = time.perf_counter() - begin
    return times[1:]
