"""Every environment, played at random."""

from __future__ import annotations

import dataclasses

import numpy as np

from mujoco_impact.errors import ImpactError
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact_lab.domains.scenes import Player, Scene

ACTIONS = 1000
"""Random actions in an environment."""


@dataclasses.dataclass(frozen=True)
class Play:
    """What was seen of an environment that was played.

    Attributes:
        warnings: Warnings of MuJoCo.
        deepest: Largest overlap of two geoms after an action [m].
        fastest: Largest velocity of a degree of freedom then [m/s, rad/s].
    """

    warnings: int
    deepest: float
    fastest: float


@dataclasses.dataclass(frozen=True)
class Tour:
    """An environment with our contacts and with MuJoCo's.

    Attributes:
        scene: The environment.
        stock: What was seen with MuJoCo's contacts; None if ours are refused.
        ours: What was seen with ours; None if they are refused.
        refusal: Why, or "".
    """

    scene: Scene
    stock: Play | None
    ours: Play | None
    refusal: str = ""


def tour(scene: Scene, *, actions: int = ACTIONS, restitution: float = 1.0) -> Tour:
    """Plays an environment with our contacts and with MuJoCo's.

    Args:
        scene: The environment.
        actions: How many actions it is given.
        restitution: Of our contacts, in [0, 1].
    """
    try:
        player = scene.ours(restitution)
    except ImpactError as error:
        return Tour(scene, None, None, str(error))
    return Tour(scene, _play(scene.stock(), actions), _play(player, actions))


def _play(player: Player, actions: int) -> Play:
    """Plays an environment."""
    random = np.random.default_rng(0)
    data = player.data
    player.reset(0)
    deepest = fastest = 0.0
    with collected_warnings() as messages:
        for _ in range(actions):
            player.step(random.uniform(-1, 1, player.model.nu))
            fastest = max(fastest, float(np.abs(data.qvel).max(initial=0.0)))
            deepest = max(deepest, -float(data.contact.dist.min(initial=0.0)))
    return Play(len(messages), deepest, fastest)
