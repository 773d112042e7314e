"""What a step of an environment costs: our contacts beside MuJoCo's, and raw MuJoCo.

Two environments take turns in blocks of steps, each first in half of them, so that
both see the same load of the machine; a ratio is the median over the blocks. Times are
of the processor (one thread), so that waiting for it does not count.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mujoco_impact import envs
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, DOMAIN, TASKS
from mujoco_impact.errors import ImpactWarning
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array

BLOCK = 25
"""Control steps between two readings of the clock."""

EPISODE = 250
"""Control steps after which an episode begins anew."""

STOCK: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("ball_in_cup", "catch", {"geoms": ["ball"]}),
    ("quadruped", "fetch", {"geoms": ["ball"]}),
    ("humanoid", "stand", {}),
)
"""Domains that are not ours; all geoms that can are owned unless some are named."""


@dataclass(frozen=True)
class StepCost:
    """Cost of one control step of one environment.

    Attributes:
        environment: Library, domain and task.
        owned: Geoms whose contacts are ours, "all" for every one that can collide.
        ours: Time with our contacts, median [us].
        mujoco: The same with MuJoCo's contacts [us].
        ratio: Median of the ratios of blocks one after another.
        physics: The part of `ours` that is `mj_step` alone, median [us].
        overhead: Median of environment step over `mj_step` alone.
    """

    environment: str
    owned: str
    ours: float
    mujoco: float
    ratio: float
    physics: float
    overhead: float


Player = Callable[[], tuple[float, float]]
"""Plays a block; returns the time of the whole and of its physics alone, per step [s].
"""


def step_costs(
    blocks: int, progress: Callable[[float], None] | None = None
) -> list[StepCost]:
    """Measures the tasks of the cradle, under both libraries, and `STOCK`.

    Args:
        blocks: Blocks of each environment.
        progress: Called with the finished fraction.
    """
    pairs: list[tuple[str, str, Player, Player]] = []
    for task in TASKS:
        pairs.append((f"dm_control {DOMAIN} {task}", "all", *_cradles(task)))
        pairs.append((f"gymnasium {DOMAIN} {task}", "all", *_gymnasium(task)))
    for domain, task, options in STOCK:
        owned = ", ".join(options.get("geoms", ["all"]))
        name = f"dm_control {domain} {task}"
        pairs.append((name, owned, *_stock(domain, task, options)))
    costs = []
    for number, pair in enumerate(pairs, start=1):
        costs.append(_compare(*pair, blocks=blocks))
        if progress is not None:
            progress(number / len(pairs))
    return costs


def _compare(
    environment: str, owned: str, ours: Player, stock: Player, *, blocks: int
) -> StepCost:
    """Plays two environments in turns."""
    ours(), stock()  # warms up
    turns = [_turn(ours, stock, first=block % 2) for block in range(blocks)]
    whole, physics, other = np.array(turns).T
    return StepCost(
        environment=environment,
        owned=owned,
        ours=round(float(np.median(whole)) * 1e6, 1),
        mujoco=round(float(np.median(other)) * 1e6, 1),
        ratio=round(float(np.median(whole / other)), 3),
        physics=round(float(np.median(physics)) * 1e6, 1),
        overhead=round(float(np.median(whole / physics)), 2),
    )


def _turn(ours: Player, stock: Player, *, first: int) -> tuple[float, float, float]:
    """Plays a block of both; returns the times of ours, its physics, and stock [s]."""
    if first == 0:
        whole, physics = ours()
        other, _ = stock()
    else:
        other, _ = stock()
        whole, physics = ours()
    return whole, physics, other


def _cradles(task: str) -> tuple[Player, Player]:
    """Returns the dm_control environment of a task with ours and MuJoCo's contacts."""
    players = []
    for contacts in ("impact", "mujoco"):
        kwargs = {"random": 0, "contacts": contacts}
        players.append(_dm_player(envs.load("cradle", task, task_kwargs=kwargs)))
    return players[0], players[1]


def _stock(domain: str, task: str, options: dict[str, Any]) -> tuple[Player, Player]:
    """Returns a stock environment with ours and MuJoCo's contacts."""
    suite = require("dm_control.suite")
    kwargs = {"random": 0}
    with warnings.catch_warnings():
        # only costs count here: what force sensors miss does not
        warnings.simplefilter("ignore", ImpactWarning)
        ours = envs.load(domain, task, task_kwargs=kwargs, **options)
    stock = suite.load(
        domain, task, task_kwargs=kwargs, environment_kwargs={"legacy_step": False}
    )
    return _dm_player(ours), _dm_player(stock)


def _dm_player(environment: Any) -> Player:
    """Returns the player of a dm_control environment."""
    physics = environment.physics
    return _player(
        model=physics.model.ptr,
        data=physics.data.ptr,
        substeps=round(environment.control_timestep() / physics.timestep()),
        reset=environment.reset,
        step=environment.step,
    )


def _gymnasium(task: str) -> tuple[Player, Player]:
    """Returns the gymnasium environment of a task with ours and MuJoCo's contacts."""
    gymnasium = require("gymnasium")
    name = envs.environment_id(DOMAIN, task)
    players = []
    for contacts in ("impact", "mujoco"):
        environment = gymnasium.make(name, contacts=contacts).unwrapped
        players.append(_gymnasium_player(environment))
    return players[0], players[1]


def _gymnasium_player(environment: Any) -> Player:
    """Returns the player of a gymnasium environment."""
    return _player(
        model=environment.model,
        data=environment.data,
        substeps=round(CONTROL_TIMESTEP / environment.model.opt.timestep),
        reset=environment.reset,
        step=environment.step,
    )


def _player(
    *,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    substeps: int,
    reset: Callable[[], Any],
    step: Callable[[Array], Any],
) -> Player:
    """Returns a function that plays the next block of an environment.

    Each block is played twice from the same state: by the environment, and as physics
    alone, with the same actions.
    """
    random = np.random.default_rng(0)
    bare = mujoco.MjData(model)
    played = EPISODE

    def play() -> tuple[float, float]:
        nonlocal played
        if played >= EPISODE:
            reset()
            played = 0
        actions = random.uniform(-1.0, 1.0, (BLOCK, model.nu))
        mujoco.mj_copyData(bare, model, data)
        begin = time.thread_time()
        for action in actions:
            step(action)
        middle = time.thread_time()
        for action in actions:
            bare.ctrl[:] = action
            mujoco.mj_step(model, bare, nstep=substeps)
        end = time.thread_time()
        played += BLOCK
        return (middle - begin) / BLOCK, (end - middle) / BLOCK

    return play
