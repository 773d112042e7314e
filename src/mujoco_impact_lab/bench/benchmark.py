"""Running the benchmark: every scene with every method that suits it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from mujoco_impact.errors import ConfigError
from mujoco_impact_lab.bench import compiled, mujoco_methods, peers, sequential
from mujoco_impact_lab.bench.impacts import (
    ImpactTimes,
    WaveTimes,
    impact_times,
    wave_times,
)
from mujoco_impact_lab.bench.library import library_obstacle
from mujoco_impact_lab.bench.machine import machine, versions
from mujoco_impact_lab.bench.measure import QUICK, Effort, SceneBench
from mujoco_impact_lab.bench.methods import MethodFamily
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import Results
from mujoco_impact_lab.bench.scenes import BenchScene, choose_scenes
from mujoco_impact_lab.bench.steps import StepTimes, step_times
from mujoco_impact_lab.bench.truths import truth_of

_Times: TypeAlias = tuple[
    tuple[StepTimes, ...], tuple[ImpactTimes, ...], tuple[WaveTimes, ...]
]
_NO_TIMES: _Times = ((), (), ())


class BenchmarkInterrupted(KeyboardInterrupt):
    """A benchmark was interrupted by hand (Ctrl-C).

    Attributes:
        results: Those of the scenes that are done.
    """

    def __init__(self, results: Results) -> None:
        """Stores the results."""
        super().__init__(f"interrupted after {', '.join(results.scenes)}")
        self.results = results


def run_benchmark(
    *,
    scenes: Sequence[str] | None = None,
    methods: Sequence[str] | None = None,
    quick: bool = False,
    steps: bool = True,
    progress: Callable[[str], None] | None = None,
) -> Results:
    """Measures run time and error of every method in every scene.

    Args:
        scenes: Names of scenes; None: all.
        methods: Names of methods; None: all.
        quick: Only the recommended settings, and few timings.
        steps: Whether to time single steps and impacts, too.
        progress: Called with each stage as it begins.

    Raises:
        SceneError: If a scene is unknown.
        ConfigError: If a method is unknown.
        BenchmarkInterrupted: On Ctrl-C, once a scene is done; it is a
            KeyboardInterrupt, and holds the results until then.
    """
    report = progress or (lambda _: None)
    chosen_scenes = choose_scenes(None if scenes is None else list(scenes))
    families = choose_methods(methods)
    effort = QUICK if quick else Effort()
    points, done = list[Point](), list[BenchScene]()
    timed, stopped = _NO_TIMES, False
    try:
        for scene in chosen_scenes:
            points += _scene_points(scene, families, effort, quick, report)
            done.append(scene)
        if steps:
            timed = _times(quick, report)
    except KeyboardInterrupt:
        if not done:
            raise
        stopped = True
    results = Results(
        scenes={scene.name: scene.title for scene in done},
        methods={family.name: family.title for family in families},
        points=tuple(points),
        steps=timed[0],
        impacts=timed[1],
        waves=timed[2],
        missing=_missing(done, families, steps=steps),
        versions=versions(families),
        machine=machine(),
        quick=quick,
    )
    if stopped:
        raise BenchmarkInterrupted(results)
    return results


def choose_methods(names: Sequence[str] | None) -> tuple[MethodFamily, ...]:
    """Returns the methods of the given names, all of them for None.

    Raises:
        ConfigError: If a name is unknown.
    """
    known = {
        family.name: family
        for family in (
            *mujoco_methods.families(),
            sequential.family(),
            compiled.family(),
            *peers.families(),
        )
    }
    for name in names or ():
        if name not in known:
            msg = f"there is no method {name!r} (available: {', '.join(known)})"
            raise ConfigError(msg)
    return tuple(known.values() if names is None else (known[name] for name in names))


def _scene_points(
    scene: BenchScene,
    families: Sequence[MethodFamily],
    effort: Effort,
    quick: bool,
    report: Callable[[str], None],
) -> list[Point]:
    """Returns the points of one scene."""
    candidates = [
        candidate
        for family in families
        for candidate in family.candidates
        if not candidate.obstacle(scene) and (candidate.quick or not quick)
    ]
    report(f"{scene.name}: Hertz reference")
    bench = SceneBench(scene, truth_of(scene), effort)
    points = list[Point]()
    for number, candidate in enumerate(candidates, start=1):
        report(f"{scene.name}: {candidate.method} ({number} of {len(candidates)})")
        points.append(bench.point(candidate))
    return points


def _times(quick: bool, report: Callable[[str], None]) -> _Times:
    """Times single steps, and the law alone if the library is there."""
    duration, repeats = (2.0, 2) if quick else (20.0, 9)
    steps = step_times(duration=duration, repeats=repeats, progress=report)
    if library_obstacle():
        return steps, (), ()
    rounds = 5 if quick else 25
    impacts = impact_times(rounds=rounds, progress=report)
    return steps, impacts, wave_times(rounds=rounds, progress=report)


def _missing(
    scenes: Sequence[BenchScene], families: Sequence[MethodFamily], *, steps: bool
) -> dict[str, str]:
    """Returns why methods were not measured, at all or in some scenes."""
    reasons = {family.name: family.missing for family in families if family.missing}
    if steps and library_obstacle():
        for what in ("the law alone", "steps with an empty plugin"):
            reasons[what] = library_obstacle()
    for family in families:
        for scene in scenes:
            obstacles = [one.obstacle(scene) for one in family.candidates]
            if obstacles and all(obstacles):
                reasons[f"{family.name} on {scene.name}"] = obstacles[0]
    return reasons
