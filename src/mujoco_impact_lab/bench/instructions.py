"""Instructions that the impact law executes, counted by callgrind.

Unlike run times they hardly depend on the machine and not at all on its load, so two
versions can be compared. `scripts/bench-instructions` builds the program and calls
this module.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TypedDict

from mujoco_impact_lab.bench.callgrind import count_in
from mujoco_impact_lab.bench.step_instructions import count_steps, workloads

BALLS = (3, 5, 10, 50, 200)

REPEATS = {3: 50, 5: 50, 10: 20, 50: 5, 200: 1}
"""Solves of each row; the count is divided by it."""

GAP = 1e-4
"""Gaps of the second workload, in which the pairs collide one after another [m]."""

COUNTED = "MeasuredImpact"
"""The function of the program that is counted, see plugin/bench/law_workload.cc."""


class Count(TypedDict):
    """Instructions of one workload.

    Attributes:
        balls: Number of balls of the row.
        gap: Gaps between them [m]; 0: they touch.
        steps: Integration steps of one solve.
        instructions: Instructions of one solve.
        per_step_and_contact: The same for each step and contact.
    """

    balls: int
    gap: float
    steps: int
    instructions: int
    per_step_and_contact: float


def count_instructions(program: Path, *, balls: int, gap: float = 0.0) -> Count:
    """Counts the instructions of the impact of one row.

    Args:
        program: The program `law_workload`.
        balls: Number of balls.
        gap: Gap between them [m].

    Raises:
        InstructionsError: If valgrind is missing or the program failed.
    """
    repeats = REPEATS.get(balls, 1)
    arguments = map(str, (balls, repeats, gap))
    collected, steps = count_in(program, f"{COUNTED}*", *arguments)
    instructions = collected // repeats
    each = instructions / (steps * (balls - 1))
    return Count(
        balls=balls,
        gap=gap,
        steps=steps,
        instructions=instructions,
        per_step_and_contact=round(each, 1),
    )


FRICTION = {"rack": 0.06, "face": 0.3, "edge": 0.3, "corner": 0.3}
"""Scenes of plugin/bench/friction_workload.cc and their coefficients of friction."""


class FrictionCount(TypedDict):
    """Instructions of one impact with friction, and of the same without.

    Attributes:
        scene: What strikes what.
        steps: Integration steps with friction.
        instructions: Instructions with friction.
        without: Instructions without tangential rows.
        ratio: Of the two.
    """

    scene: str
    steps: int
    instructions: int
    without: int
    ratio: float


def count_friction(program: Path, scene: str) -> FrictionCount:
    """Counts the instructions of one impact with friction and without.

    Args:
        program: The program `friction_workload`.
        scene: A key of `FRICTION`.

    Raises:
        InstructionsError: If valgrind is missing or the program failed.
    """
    without, _ = count_in(program, "*SolveImpact(*", scene, "0")
    instructions, steps = count_in(
        program, "*SolveImpact(*", scene, str(FRICTION[scene])
    )
    return FrictionCount(
        scene=scene,
        steps=steps,
        instructions=instructions,
        without=without,
        ratio=round(instructions / without, 2),
    )


def write_counts(
    program: Path, friction_program: Path, step_program: Path, file: Path
) -> None:
    """Counts every workload and writes the JSON file."""
    rows = [(balls, gap) for gap in (0.0, GAP) for balls in BALLS]
    counts = {
        "counts": (count_instructions(program, balls=n, gap=gap) for n, gap in rows),
        "friction": (count_friction(friction_program, scene) for scene in FRICTION),
        "steps": (count_steps(step_program, workload) for workload in workloads()),
    }
    parts = list[str]()
    for name, each in counts.items():
        lines = list[str]()
        for count in each:
            lines.append(json.dumps(count))
            sys.stdout.write(f"{lines[-1]}\n")
        parts.append(f'"{name}": [\n  ' + ",\n  ".join(lines) + "\n]")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("{" + ",\n".join(parts) + "}\n", encoding="utf-8")
