"""One case: its scene is run, and what was asked for is read off."""

from __future__ import annotations

import dataclasses
import threading
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco

from mujoco_impact.baselines import Method, baselines
from mujoco_impact.comparing.compare import interleaved_times
from mujoco_impact.comparing.judge import Judge
from mujoco_impact.comparison import OURS, MethodResult
from mujoco_impact.errors import ImpactWarning
from mujoco_impact.pulses import geom_name
from mujoco_impact.remarks import QUIET
from mujoco_impact.runner import initial_data, load_model, run, step_count
from mujoco_impact.sweeping.parameters import ITSELF, Value
from mujoco_impact.sweeping.quantities import (
    CLOCK,
    REFERENCE,
    Outcome,
    Recorded,
    needs,
    recorded,
)
from mujoco_impact.sweeping.scenes import CaseScene, scene_of
from mujoco_impact.trajectory import Trajectory

REMARKS, ERROR = "remarks", "error"
"""Columns of what deserves attention, and of why a case failed."""

_alone = threading.Lock()
"""A process has one filter of warnings, and a clock wants one run at a time. So of the
threads of a worker one runs a case."""


@dataclasses.dataclass(frozen=True)
class Task:
    """One case to run.

    Attributes:
        case: All its parameters.
        folder: Where files of models are, unless their path says so.
        record: What to record.
    """

    case: Mapping[str, Value]
    folder: str
    record: tuple[str, ...]

    @property
    def cost(self) -> float:
        """What it costs beside other cases: number of steps, if they are told."""
        duration, timestep = self.case["duration"], self.case.get("timestep", 1.0)
        return float(str(duration)) / float(str(timestep))


def run_case(task: Task) -> dict[str, Recorded]:
    """Returns what was recorded of a case by the names of columns.

    A case that fails has its reason in the column `error`, and nothing else.
    """
    with _alone, warnings.catch_warnings():
        # remarks of a run stand in the row
        warnings.simplefilter("ignore", ImpactWarning)
        try:
            return _row(task)
        except Exception as error:
            # whatever it is: the other cases are none the worse for it
            text = " ".join(str(error).split())
            return {ERROR: f"{type(error).__name__}: {text}"}


def _row(task: Task) -> dict[str, Recorded]:
    """Returns what was recorded of a case that does not fail."""
    scene = scene_of(task.case, Path(task.folder))
    wanted = needs(task.record)
    method = Method(OURS, "", scene.attached)
    row: dict[str, Recorded] = {}
    # MuJoCo's settings are tuned for the first impact of our motion
    if wanted != {CLOCK} or task.case["method"] != OURS:
        ours = run(scene.attached, duration=scene.duration, **scene.start)
        judge = Judge(scene.attached, scene.plain, ours, scene.law)
        judge.find_references()
        method = _method(task, scene, judge)
        row |= _measured(task, scene, judge, method, ours)
    if CLOCK in wanted:
        row["run_time"] = _run_time(scene, method)
    return row


def _method(task: Task, scene: CaseScene, judge: Judge) -> Method:
    """Returns the method of a case."""
    tuned_for = task.case["tuned_for"]
    speed = judge.speed if tuned_for == ITSELF else float(str(tuned_for))
    methods = baselines(
        scene.plain, impact_speed=speed, restitution=judge.material.restitution
    )
    ours = Method(OURS, "", scene.attached)
    return next(one for one in (ours, *methods) if one.name == task.case["method"])


def _measured(
    task: Task, scene: CaseScene, judge: Judge, method: Method, ours: Trajectory
) -> dict[str, Recorded]:
    """Returns what the motion of a method came to."""
    motion = ours
    if method.name != OURS:
        motion = run(
            method.spec, duration=scene.duration, every=method.every, **scene.start
        )
    results = [
        judge.measured(MethodResult(name, "", one))
        for name, one in ((OURS, ours), (method.name, motion))
    ]
    comparison = judge.comparison(scene.duration, results)
    outcome = Outcome(
        numbers=comparison.table()[-1],
        result=results[-1],
        first=comparison.first,
        bodies=comparison.bodies,
        geoms=frozenset(_geoms(comparison.model)),
        scale=comparison.energy_scale,
        speed=judge.speed,
    )
    row: dict[str, Recorded] = {}
    for name in task.record:
        row |= recorded(name, outcome)
    remarks = [one.kind for one in motion.remarks if one.kind not in QUIET]
    if comparison.note and REFERENCE in needs(task.record):
        remarks.append(" ".join(comparison.note.split()))
    row[REMARKS] = "; ".join(remarks) or None
    return row


def _run_time(scene: CaseScene, method: Method) -> float:
    """Returns the run time of a simulated second [s]."""
    model = load_model(method.spec)
    data = initial_data(model, **scene.start)
    steps = step_count(model, scene.duration)
    times = interleaved_times([model], [data], [steps], repeats=1)
    return float(times[0, 0]) / scene.duration


def names_in(case: Mapping[str, Any], folder: Path) -> tuple[list[str], list[str]]:
    """Returns the names of the geoms of a scene, and of its bodies that can move.

    The scene is made whole, so that what does not fit it is told before anything runs.

    Raises:
        ImpactError: If there is no such scene, or it does not take a value.
    """
    model = load_model(scene_of(case, folder).attached)
    bodies = [
        model.body(body).name or f"body {body}"
        for body in range(1, model.nbody)
        if model.body_weldid[body] != 0
    ]
    return _geoms(model), bodies


def _geoms(model: mujoco.MjModel) -> list[str]:
    """Returns the names of the geoms of a scene, as impacts call them."""
    return [geom_name(model, geom) for geom in range(model.ngeom)]
