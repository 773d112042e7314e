"""Scores of policies. Importing this module needs gymnasium."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from mujoco_impact.envs import environment_id
from mujoco_impact.envs.tasks import DOMAIN, TASKS
from mujoco_impact.extras import require
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.policies import POLICIES

EPISODES = 20
"""Episodes that a score of the documentation is the mean of; seeds 0 to 19."""

Policy = Literal["random", "scripted"]


def score(task: str, policy: Policy, *, episodes: int = EPISODES) -> Array:
    """Returns the sum of rewards of each episode, shape (episodes,); at most 500.

    Args:
        task: One of `TASKS`.
        policy: "random" for uniform actions, "scripted" for `POLICIES`.
        episodes: How many, with the seeds 0, 1, ...
    """
    env: Any = require("gymnasium").make(environment_id(DOMAIN, task))
    found = np.array([_episode(env, task, policy, seed) for seed in range(episodes)])
    env.close()
    return found


def _episode(env: Any, task: str, policy: Policy, seed: int) -> float:
    """Returns the sum of rewards of one episode."""
    random = np.random.default_rng(seed)
    names = env.unwrapped.observation_names
    observation, _ = env.reset(seed=seed)
    total, truncated = 0.0, False
    while not truncated:
        if policy == "random":
            action = random.uniform(-1.0, 1.0, env.action_space.shape)
        else:
            parts = {name: observation[where] for name, where in names.items()}
            action = POLICIES[task](parts)
        observation, reward, _, truncated, _ = env.step(action)
        total += reward
    return total


def table() -> str:
    """Returns mean and standard deviation of every task and policy, as Markdown."""
    lines = ["| task | random | scripted |", "|---|---|---|"]
    policies: tuple[Policy, ...] = ("random", "scripted")
    for task in TASKS:
        found = [score(task, policy) for policy in policies]
        shown = [f"{one.mean():.0f} ± {one.std():.0f}" for one in found]
        lines.append(f"| `{task}` | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"
