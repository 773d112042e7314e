"""Running the benchmark of friction, and what it leaves behind."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from mujoco_impact.errors import SceneError
from mujoco_impact_lab.bench.charts import draw_charts
from mujoco_impact_lab.bench.friction.box import bouncing_box
from mujoco_impact_lab.bench.friction.dominoes import domino_row
from mujoco_impact_lab.bench.friction.engines import (
    ENGINES,
    engine_settings,
    obstacle,
)
from mujoco_impact_lab.bench.friction.methods import (
    FrictionSimulation,
    MujocoMotions,
    Setting,
    mujoco_settings,
)
from mujoco_impact_lab.bench.friction.rack import billiard_break
from mujoco_impact_lab.bench.friction.scene import FrictionScene
from mujoco_impact_lab.bench.machine import machine, versions
from mujoco_impact_lab.bench.measure import QUICK, Effort, Race
from mujoco_impact_lab.bench.methods import MethodFamily
from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS
from mujoco_impact_lab.bench.peers.common import installed
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.results import Results, write_results
from mujoco_impact_lab.bench.truths import Errors

SCENES: dict[str, Callable[[], FrictionScene]] = {
    "break": billiard_break,
    "box": bouncing_box,
    "dominoes": domino_row,
}

TITLES = {
    OURS: "mujoco-impact",
    DEFAULT: "MuJoCo, defaults",
    "mujoco-damper": "MuJoCo, expert: reflecting damper",
    "mujoco-compliant": "MuJoCo, expert: spring and damper",
    "mujoco-hertz": "MuJoCo, expert: Hertz-like",
    **{name: engine[2] for name, engine in ENGINES.items()},
}
"""What each method is, for legends."""

NO_FRICTION = "its contacts of spheres have no friction"

ERRORS = {"velocity_error": "error against the truth (see the title)"}
"""What is drawn over the run time, and its label."""

EFFORT = Effort(repeats=5, budget=0.3, least=3)


def run_friction(
    *,
    scenes: Sequence[str] | None = None,
    quick: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Results:
    """Measures run time and error of every method in every scene with friction.

    Args:
        scenes: Names of scenes; None: all.
        quick: Only one setting of each method, and few timings.
        progress: Called with each stage as it begins.

    Raises:
        SceneError: If a scene is unknown.
    """
    report = progress or (lambda _: None)
    names = tuple(SCENES) if scenes is None else tuple(scenes)
    for name in names:
        if name not in SCENES:
            msg = f"there is no scene {name!r} (available: {', '.join(SCENES)})"
            raise SceneError(msg)
    points, missing, titles = list[Point](), {"exudyn": NO_FRICTION}, dict[str, str]()
    for name in names:
        report(f"{name}: truth")
        scene = SCENES[name]()
        titles[name] = scene.title
        missing |= {
            f"{engine} on {name}": obstacle(engine, scene)
            for engine in ENGINES
            if obstacle(engine, scene)
        }
        points += _points(scene, quick, report)
    return Results(
        scenes=titles,
        methods=TITLES,
        points=tuple(points),
        steps=(),
        impacts=(),
        waves=(),
        missing=missing,
        versions=versions(_engines()),
        machine=machine(),
        quick=quick,
    )


def write_friction(results: Results, folder: Path) -> tuple[Path, ...]:
    """Writes results and charts; returns the paths written."""
    files = write_results(results, folder)
    return (*files, *draw_charts(results, folder, ERRORS))


def _points(
    scene: FrictionScene, quick: bool, report: Callable[[str], None]
) -> list[Point]:
    """Returns the points of one scene."""
    settings = [one for one in _settings(scene) if one.quick or not quick]
    base = MujocoMotions(scene, scene.spec())
    race = Race(base, scene.duration * len(scene.starts), QUICK if quick else EFFORT)

    def errors(simulation: FrictionSimulation) -> Errors:
        error = scene.error(simulation.record())
        return Errors(error if math.isfinite(error) else math.inf)

    points = list[Point]()
    for number, one in enumerate(settings, start=1):
        report(f"{scene.name}: {one.method} ({number} of {len(settings)})")
        blank = Point(scene.name, one.method, one.words, one.integrator, one.timestep)
        points.append(race.point(blank, partial(one.build, scene), errors))
    return points


def _settings(scene: FrictionScene) -> Iterator[Setting]:
    yield from mujoco_settings(scene)
    for name in ENGINES:
        if not obstacle(name, scene):
            yield from engine_settings(name)


def _engines() -> Iterator[MethodFamily]:
    """Yields the engines, for their versions."""
    for name, (package, _, title, *_) in ENGINES.items():
        yield MethodFamily(name, title, (), installed(package) or "")
