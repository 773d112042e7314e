"""Instructions of steps in which there is nothing to do for us, and of whole swings.

Beside steps of the same scene without the plugin: MuJoCo alone for what rests and what
swings, the floor (`step_cases`) for what flies freely.
"""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TypedDict

import mujoco
import numpy as np

import cradle_models
from mujoco_impact import _plugin
from mujoco_impact.runner import initial_data, load_model
from mujoco_impact.scene import attach
from mujoco_impact.source import read_spec
from mujoco_impact_lab.bench.callgrind import count_in
from mujoco_impact_lab.bench.library import library_path
from mujoco_impact_lab.bench.simulate import START
from mujoco_impact_lab.bench.step_cases import step_cases

COUNTED = "MeasuredSteps*"
"""The function that is counted, see plugin/bench/step_workload.cc."""

MUJOCO_PLUGINS = Path(mujoco.__file__).parent / "plugin"
"""Folder of MuJoCo's own plugins, which Python loads first."""

SETTLED, STEPS, SWING = 2500, 100, 1500
"""Steps of 2 ms after which bodies rest, and those that are counted: of a state that
stays, and of a swing of 3 s."""

IDLE = ("no contact", "nothing closes", "empty plugin")
"""Steps of `step_cases` of rows of 5 and 50 in which no impact comes."""


class StepCount(TypedDict):
    """Instructions of one step.

    Attributes:
        scene: What is stepped.
        instructions: With the plugin.
        without: Without it.
        ratio: Of the two.
    """

    scene: str
    instructions: int
    without: int
    ratio: float


@dataclasses.dataclass(frozen=True)
class Workload:
    """Steps with and without the plugin.

    Attributes:
        scene: What is stepped.
        specs: Makes the scene with the plugin, and the one beside it.
        settled: Steps before the first that counts.
        steps: Steps that count.
    """

    scene: str
    specs: Callable[[], tuple[mujoco.MjSpec, mujoco.MjSpec]]
    settled: int = 0
    steps: int = STEPS


def count_steps(program: Path, workload: Workload) -> StepCount:
    """Counts the instructions of a step with the plugin and without.

    Args:
        program: The program `step_workload`.
        workload: What to step.

    Raises:
        InstructionsError: If valgrind is missing or the program failed.
    """
    counts = [
        _count(program, load_model(spec), workload.settled, workload.steps)
        for spec in workload.specs()
    ]
    return StepCount(
        scene=workload.scene,
        instructions=counts[0],
        without=counts[1],
        ratio=round(counts[0] / counts[1], 3),
    )


def workloads() -> Sequence[Workload]:
    """Returns what is counted."""
    ball = '<geom size=".02"/>'
    box = '<geom type="box" size=".05 .05 .05"/>'
    stack = [0.05 + 0.1 * k for k in range(5)]
    rests = {
        "a ball rests": _on_a_floor(ball, [0.02]),
        "a box rests": _on_a_floor(box, [0.05]),
        "five boxes rest on each other": _on_a_floor(box, stack),
        "a box rests on a slope of 20 degrees": _on_a_floor(box, [0.05], slope=20.0),
    }
    swings = {f"{count} swinging balls": "A" * count for count in (3, 5)}
    return (
        *(
            Workload(scene, partial(_beside_alone, xml), settled=SETTLED)
            for scene, xml in rests.items()
        ),
        *(
            Workload(scene, partial(_beside_alone, cradle_models.row(row)), steps=SWING)
            for scene, row in swings.items()
        ),
        *(
            Workload(case.title, case.specs)
            for case in step_cases(library=True)
            if case.balls in (5, 50) and case.title.endswith(IDLE)
        ),
    )


def _on_a_floor(geom: str, heights: list[float], *, slope: float = 0.0) -> str:
    """Bodies on a plane, at these heights over it [m]; it slopes down along x [deg]."""
    along = np.array([np.sin(np.radians(slope)), 0.0, np.cos(np.radians(slope))])
    bodies = "".join(
        f'<body pos="{" ".join(map(str, height * along))}" euler="0 {slope} 0">'
        f"<freejoint/>{geom}</body>"
        for height in heights
    )
    return f"""
    <mujoco>
      <default><geom friction=".5"/></default>
      <worldbody>
        <geom type="plane" size="5 5 .1" euler="0 {slope} 0"/>{bodies}
      </worldbody>
    </mujoco>"""


def _beside_alone(xml: str) -> tuple[mujoco.MjSpec, mujoco.MjSpec]:
    """Returns the scene with the plugin on all of it, and without."""
    return attach(xml), read_spec(xml)


def _count(program: Path, model: mujoco.MjModel, settled: int, steps: int) -> int:
    """Returns the instructions of a step."""
    data = initial_data(model, keyframe=START if model.nkey else None)
    mujoco.mj_step(model, data, nstep=settled)
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    with tempfile.TemporaryDirectory() as folder:
        files = Path(folder, "model.mjb"), Path(folder, "state")
        mujoco.mj_saveModel(model, str(files[0]), None)
        state.tofile(files[1])
        plugins = (MUJOCO_PLUGINS, _plugin.plugin_path(), library_path())
        arguments = map(str, (*files, steps, *plugins))
        collected, _ = count_in(program, COUNTED, *arguments)
    return collected // steps
