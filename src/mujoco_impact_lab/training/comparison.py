"""What `strike` teaches under our contacts and under MuJoCo's, and what it is worth."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any

import gymnasium
import numpy as np

import cradle_models
from mujoco_impact.baselines import damper
from mujoco_impact.envs.cradle import RESTITUTION, TIMESTEP
from mujoco_impact.envs.tasks import CONTROL_TIMESTEP, OUT_ANGLE, TIME_LIMIT
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench import policies
from mujoco_impact_lab.training import strike
from mujoco_impact_lab.training.strike import MakeEnv, Policy

EPISODE = round(TIME_LIMIT / CONTROL_TIMESTEP)
"""Steps of an episode of a score."""

EPISODES = 20
"""Episodes of a score; seeds 0 to 19, which the training does not use."""

SCORE_EVERY = 10
"""Generations from one point of a learning curve to the next."""


def defaults(steps: int) -> Any:
    """Returns the environment with MuJoCo's contacts as they are."""
    return gymnasium.make(strike.ID, max_episode_steps=steps, contacts="mujoco")


def reflecting(steps: int) -> Any:
    """Returns it with MuJoCo's contacts as reflecting dampers of our restitution."""
    env = defaults(steps)
    spec = read_spec(cradle_models.row("AAAAA", timestep=TIMESTEP))
    tuned = compile_spec(damper(spec, TIMESTEP, RESTITUTION).spec)
    model = env.unwrapped.model
    model.geom_solref[:], model.geom_solimp[:] = tuned.geom_solref, tuned.geom_solimp
    model.opt.cone, model.opt.enableflags = tuned.opt.cone, tuned.opt.enableflags
    return env


CONTACTS: Mapping[str, MakeEnv] = MappingProxyType(
    {
        "ours": strike.make_env,
        "MuJoCo's defaults": defaults,
        "MuJoCo's damper": reflecting,
    }
)
"""What makes the environment with each kind of contacts."""


@dataclass(frozen=True)
class Score:
    """What a policy came to in the episodes of a score.

    Attributes:
        mean: Sum of rewards of an episode, at most 500.
        deviation: Its standard deviation.
        balls: How many balls swing out together, mean; the last one included.
    """

    mean: float
    deviation: float
    balls: float


@dataclass(frozen=True)
class Training:
    """How a policy was learned.

    Attributes:
        generations: Points of the learning curve.
        scores: Score of the middle of the search there.
        parameters: What was learned, see `strike.act`.
    """

    generations: list[int]
    scores: list[Score]
    parameters: list[float]


@dataclass(frozen=True)
class Comparison:
    """What all trainings came to.

    Attributes:
        trainings: By the contacts they were done under.
        scores: By player, and by the contacts that were played under.
    """

    trainings: dict[str, Training]
    scores: dict[str, dict[str, Score]]


Player = str | tuple[float, ...]
"""Who plays: "random", "scripted", or the parameters of a policy."""


class Watched:
    """A policy that counts how many balls swing out together."""

    def __init__(self, policy: Policy) -> None:
        """Takes the policy."""
        self._policy = policy
        self._speed = 0.0
        self.counts: list[int] = []

    def __call__(self, observation: Mapping[str, Array]) -> Array:
        """Counts the balls beyond half the angle of the last one as it turns round."""
        angles, speed = observation["angles"], float(observation["speeds"][-1])
        if self._speed > 0.0 >= speed and angles[-1] > OUT_ANGLE:
            self.counts.append(int(np.sum(angles > angles[-1] / 2.0)))
        self._speed = speed
        return self._policy(observation)


def policy_of(player: Player, seed: int) -> Policy:
    """Returns the policy of a player in the episode of a seed."""
    if player == "scripted":
        return policies.strike
    if player == "random":
        random = np.random.default_rng(seed)
        return lambda _: random.uniform(-1.0, 1.0, 1)
    return partial(strike.act, np.array(player))


def _episode(contacts: str, player: Player, seed: int) -> tuple[float, list[int]]:
    """Returns the sum of rewards of an episode, and what `Watched` counted in it."""
    watched = Watched(policy_of(player, seed))
    env = strike.environment(CONTACTS[contacts], EPISODE)
    total = strike.play(env, watched, seed)
    return total, watched.counts


def score(contacts: str, player: Player, pool: Executor) -> Score:
    """Returns the score of a player under one kind of contacts.

    Args:
        contacts: One of `CONTACTS`.
        player: Who plays.
        pool: Where the episodes are played.
    """
    episode = partial(_episode, contacts, player)
    totals, counts = zip(*pool.map(episode, range(EPISODES)), strict=True)
    balls = np.concatenate(counts)
    return Score(
        mean=float(np.mean(totals)),
        deviation=float(np.std(totals)),
        balls=float(balls.mean()) if balls.size else 0.0,
    )


def learn(contacts: str, pool: Executor, generations: int) -> Training:
    """Trains a policy under one kind of contacts; scores it on the way."""
    numbers: list[int] = []
    scores: list[Score] = []
    parameters: list[float] = []
    search = strike.train(CONTACTS[contacts], pool, generations=generations)
    for number, generation in enumerate(search, start=1):
        if number % SCORE_EVERY == 0 or number in (1, generations):
            parameters = generation.parameters.tolist()
            numbers.append(number)
            scores.append(score(contacts, tuple(parameters), pool))
    return Training(numbers, scores, parameters)


def compare(
    pool: Executor,
    *,
    generations: int = strike.GENERATIONS,
    report: Callable[[str], None],
) -> Comparison:
    """Trains under each kind of contacts, and lets all play under each of them.

    Args:
        pool: Where the episodes are played.
        generations: Of each training.
        report: Is told what has been done.
    """
    trainings: dict[str, Training] = {}
    players: dict[str, Player] = {"random": "random", "scripted": "scripted"}
    for name in CONTACTS:
        trainings[name] = learn(name, pool, generations)
        players[f"trained under {name}"] = tuple(trainings[name].parameters)
        report(f"trained under {name}: {trainings[name].scores[-1].mean:.0f}")
    scores = {
        player: {name: score(name, who, pool) for name in CONTACTS}
        for player, who in players.items()
    }
    return Comparison(trainings, scores)


def run(report: Callable[[str], None]) -> Comparison:
    """Compares in processes of this machine, see `compare`."""
    # a fresh interpreter: a fork would share MuJoCo's threads
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(mp_context=context) as pool:
        return compare(pool, report=report)
