"""Benchmark of the environments: step costs, rollouts, scores of policies."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mujoco_impact.text import markdown_table
from mujoco_impact_lab.bench.environment_steps import StepCost, step_costs
from mujoco_impact_lab.bench.machine import machine, versions
from mujoco_impact_lab.bench.rollout_throughput import Throughput, throughput
from mujoco_impact_lab.bench.scores import table as score_table
from mujoco_impact_lab.bench.vector_steps import VectorCost, vector_costs

BLOCKS = 300
ROUNDS = 40
ROLLOUTS = 10_000
THREADS = (1, 2)


def run(
    *, blocks: int = BLOCKS, rounds: int = ROUNDS, rollouts: int = ROLLOUTS
) -> dict[str, Any]:
    """Measures everything.

    Args:
        blocks: Blocks of 25 control steps of each environment.
        rounds: Rounds of 512 control steps of each vector environment.
        rollouts: Simulations of 1 s for each number of threads.

    Returns:
        Machine and versions, `steps` (`StepCost`), `vectors` (`VectorCost`),
        `rollouts` (`Throughput`) and `scores` (a table in Markdown).
    """
    return {
        "machine": machine(),
        "versions": versions([]),
        "steps": step_costs(blocks),
        "vectors": vector_costs(rounds),
        "rollouts": throughput(THREADS, rollouts),
        "scores": score_table(),
    }


def write(results: dict[str, Any], folder: Path) -> tuple[Path, Path]:
    """Writes the results as JSON and as a page of tables; returns the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    plain = {
        key: [dataclasses.asdict(one) for one in value]
        if isinstance(value, list)
        else value
        for key, value in results.items()
    }
    data, page = folder / "environments.json", folder / "environments.md"
    data.write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
    page.write_text(_page(results), encoding="utf-8")
    return data, page


def _page(results: dict[str, Any]) -> str:
    """Returns the page of tables."""
    where = results["machine"]
    versions_found = results["versions"]
    return f"""# Environments: costs and scores

Written by `scripts/bench-environments`, on {where["cores"]} cores of
{where["processor"]}, with MuJoCo {versions_found["mujoco"]}.

## Steps

Processor time of a control step with random actions; "MuJoCo's": the same environment
with MuJoCo's contacts; "ratio": median over blocks of 25 steps in turn. "mj_step": the
part of ours that is physics; "overhead": the environment over it.

{_step_table(results["steps"])}
## Vector environments

Control steps a second, of all environments together, by the clock, with random
actions. "loop": a Python loop over `gymnasium.make`; "sync": `SyncVectorEnv`; "ours":
`gymnasium.make_vec` with a thread for each core; ratios: medians over rounds in turn.

{_vector_table(results["vectors"])}
## Rollouts

{results["rollouts"][0].rollouts} simulations of 1 s of five balls, let go at as many
angles, by `mujoco_impact.rollout`; "result": hash of all final states.

{_rollout_table(results["rollouts"])}
## Scores

Sum of rewards of an episode, at most 500: mean and standard deviation over the seeds 0
to 19.

{results["scores"]}"""


def _step_table(costs: Sequence[StepCost]) -> str:
    """Returns the table of steps."""
    return markdown_table(
        ("environment", "owned", "ours [us]", "MuJoCo's [us]", "ratio", "mj_step [us]",
         "overhead"),
        map(_cells, costs),
    )  # fmt: skip


def _vector_table(costs: Sequence[VectorCost]) -> str:
    """Returns the table of vector environments."""
    return markdown_table(
        ("environment", "environments", "loop [1/s]", "sync [1/s]", "ours [1/s]",
         "ours/loop", "ours/sync"),
        map(_cells, costs),
    )  # fmt: skip


def _rollout_table(found: Sequence[Throughput]) -> str:
    """Returns the table of rollouts."""
    return markdown_table(
        (
            "threads",
            "rollouts",
            "time [s]",
            "processor time [s]",
            "rollouts/s",
            "result",
        ),
        map(_cells, found),
    )


def _cells(row: Any) -> list[str]:
    """Returns what a measurement holds, as text."""
    return [str(value) for value in dataclasses.astuple(row)]
