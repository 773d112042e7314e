"""Trains a polynomial to play `strike`, with CMA-ES on the processor.

    pip install ".[gymnasium]" cma
    python src/mujoco_impact_lab/training/strike.py policy.npy

The motor of the first ball of a cradle has to send the last ball to a height that is
drawn anew for each episode. This file needs nothing else of the project: copy it, and
change it.
"""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from typing import Any

import cma
import gymnasium
import numpy as np
from numpy.typing import NDArray

import mujoco_impact  # noqa: F401  (brings the environment)

Array = NDArray[np.float64]

Policy = Callable[[Mapping[str, Array]], Array]
"""Takes the observations by name and returns the action."""

MakeEnv = Callable[[int], Any]
"""Makes the environment with episodes of so many steps; a function of a module."""

ID = "mujoco_impact/CradleStrike-v0"
"""Of the environment."""

DEGREE = 3
"""Of the polynomial."""

POWERS = np.array([p for p in product(range(DEGREE + 1), repeat=4) if sum(p) <= DEGREE])
"""Powers of the four inputs in each of its terms, shape (SIZE, 4)."""

SIZE = len(POWERS)
"""Parameters of the policy: 35."""

SPREAD = 0.5
"""Standard deviation of the parameters in the first generation."""

POPULATION = 16
"""Policies of a generation."""

GENERATIONS = 120
"""Of the training."""

SEEDS = range(1_000_008, 1_000_012)
"""Episodes that every policy plays; their targets are 40, 30, 50 and 12 mm. Scores are
taken on others."""

STEPS = 250
"""Length of an episode of the training, half of that of a score."""


@dataclass(frozen=True)
class Generation:
    """What a generation came to.

    Attributes:
        parameters: Of the policy in the middle of the search, shape (SIZE,).
        reward: Mean reward of a step of each policy, shape (POPULATION,).
    """

    parameters: Array
    reward: Array


def act(parameters: Array, observation: Mapping[str, Array]) -> Array:
    """Returns the action, tanh(Σ wᵢ Π xⱼ^pᵢⱼ).

    The four x are angle and speed of the first ball, the height that the last ball
    reached, and the target, in units that make them of the order of 1.

    Args:
        parameters: The factors w of the terms, shape (SIZE,).
        observation: The observations by name.
    """
    x = np.array(
        [
            observation["angles"][0] / 0.4,
            observation["speeds"][0] / 2.5,
            observation["reach"][0] / 0.03,
            observation["target"][0] / 0.03,
        ]
    )
    terms = np.prod(x**POWERS, axis=1)
    return np.atleast_1d(np.tanh(parameters @ terms))


def play(env: Any, policy: Policy, seed: int) -> float:
    """Returns the sum of rewards of an episode."""
    names = env.unwrapped.observation_names
    observation, _ = env.reset(seed=seed)
    total, is_over = 0.0, False
    while not is_over:
        parts = {name: observation[where] for name, where in names.items()}
        observation, reward, _, is_over, _ = env.step(policy(parts))
        total += float(reward)
    return total


def make_env(steps: int) -> Any:
    """Returns the environment with the contacts of this package."""
    return gymnasium.make(ID, max_episode_steps=steps)


@cache
def environment(make_env: MakeEnv, steps: int) -> Any:
    """Returns the environment of this process."""
    return make_env(steps)


def fitness(make_env: MakeEnv, parameters: Array) -> float:
    """Returns the mean reward of a step over the episodes of the training."""
    env, policy = environment(make_env, STEPS), partial(act, parameters)
    return sum(play(env, policy, seed) for seed in SEEDS) / (STEPS * len(SEEDS))


def train(
    make_env: MakeEnv,
    pool: Executor,
    *,
    generations: int = GENERATIONS,
    seed: int = 1,
) -> Iterator[Generation]:
    """Yields one generation of the search after another.

    Args:
        make_env: Makes the environment, in each worker.
        pool: Where the episodes are played.
        generations: How many.
        seed: Of the search: the same seed gives the same policies.
    """
    options = {"seed": seed, "popsize": POPULATION, "verbose": -9}
    search = cma.CMAEvolutionStrategy(np.zeros(SIZE), SPREAD, options)
    for _ in range(generations):
        policies = search.ask()
        reward = np.array(list(pool.map(partial(fitness, make_env), policies)))
        # it minimises
        search.tell(policies, -reward)
        yield Generation(np.array(search.mean), reward)


def main(file: str = "policy.npy") -> None:
    """Trains a policy, saves its parameters, and plays 20 other episodes with it."""
    # a fresh interpreter: a fork would share MuJoCo's threads
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(mp_context=context) as pool:
        for number, found in enumerate(train(make_env, pool), start=1):
            mean, best = found.reward.mean(), found.reward.max()
            print(f"generation {number}: reward {mean:.2f}, best {best:.2f}")
            np.save(file, found.parameters)
    env, policy = make_env(2 * STEPS), partial(act, found.parameters)
    scores = [play(env, policy, seed) for seed in range(20)]
    print(f"score {np.mean(scores):.0f} ± {np.std(scores):.0f} of {2 * STEPS}")


if __name__ == "__main__":
    main(*sys.argv[1:])
