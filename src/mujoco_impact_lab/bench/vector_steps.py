"""Steps of vector environments a second, beside loops over single environments.

The ways take turns in rounds, first to last and last to first, so that all see the same
load of the machine. Times are of the clock, because threads work at the same time; a
ratio is the median over the rounds.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_impact.envs import ALL_TASKS, environment_id
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array

SIZES = (16, 64, 256)
"""Numbers of environments."""

BLOCK = 512
"""Control steps, of all environments together, between two readings of the clock."""


@dataclass(frozen=True)
class VectorCost:
    """Control steps a second of one task in as many environments.

    Attributes:
        environment: Domain and task.
        environments: How many there are.
        loop: Steps a second, of all environments together, of a Python loop over
            `gymnasium.make`, median.
        sync: The same of `SyncVectorEnv`.
        ours: The same of `ImpactVectorEnv`, with a thread for each processor.
        over_loop: Median of the ratios of `ours` over `loop`.
        over_sync: Median of the ratios of `ours` over `sync`.
    """

    environment: str
    environments: int
    loop: int
    sync: int
    ours: int
    over_loop: float
    over_sync: float


Stepper = Callable[[Array], Any]
"""Applies an action to each environment, shape (environments, size of an action)."""


def vector_costs(
    rounds: int, progress: Callable[[float], None] | None = None
) -> list[VectorCost]:
    """Measures all tasks in all sizes.

    Args:
        rounds: Rounds of each.
        progress: Called with the finished fraction.
    """
    cases = [(*game, size) for game in ALL_TASKS for size in SIZES]
    costs = []
    for number, case in enumerate(cases, start=1):
        costs.append(_measure(*case, rounds=rounds))
        if progress is not None:
            progress(number / len(cases))
    return costs


def _measure(domain: str, task: str, size: int, *, rounds: int) -> VectorCost:
    """Measures one task in one size."""
    gymnasium = require("gymnasium")
    name = environment_id(domain, task)
    singles = [gymnasium.make(name) for _ in range(size)]
    for seed, single in enumerate(singles):
        single.reset(seed=seed)
    vectors = {
        "sync": gymnasium.make_vec(name, size, vectorization_mode="sync"),
        "ours": gymnasium.make_vec(name, size),
    }
    for vector in vectors.values():
        vector.reset(seed=0)
    ways = {
        "loop": _loop(singles),
        **{way: vector.step for way, vector in vectors.items()},
    }
    found = {way: np.zeros(rounds) for way in ways}
    random = np.random.default_rng(0)
    shape = (max(1, BLOCK // size), *vectors["ours"].action_space.shape)
    for turn in range(-1, rounds):
        actions = random.uniform(-1.0, 1.0, shape)
        for way in list(ways)[:: 1 if turn % 2 else -1]:
            # the first warms up, and the last round overwrites it
            found[way][turn] = _rate(ways[way], actions)
    for one in (*singles, *vectors.values()):
        one.close()
    loop, sync, ours = (found[way] for way in ("loop", "sync", "ours"))
    return VectorCost(
        environment=f"{domain} {task}",
        environments=size,
        loop=round(float(np.median(loop))),
        sync=round(float(np.median(sync))),
        ours=round(float(np.median(ours))),
        over_loop=round(float(np.median(ours / loop)), 2),
        over_sync=round(float(np.median(ours / sync)), 2),
    )


def _loop(singles: list[Any]) -> Stepper:
    """Returns the loop over single environments; it begins episodes anew."""

    def step(actions: Array) -> None:
        for single, action in zip(singles, actions, strict=True):
            *_, truncated, _ = single.step(action)
            if truncated:
                single.reset()

    return step


def _rate(step: Stepper, actions: Array) -> float:
    """Returns steps a second, of all environments together."""
    begin = time.perf_counter()
    for one in actions:
        step(one)
    steps = len(actions) * len(actions[0])
    return steps / (time.perf_counter() - begin)
