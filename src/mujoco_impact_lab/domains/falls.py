"""Robots that move at random for half of the time, and then lie."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact_lab.domains.costs import Costs, CostSampler
from mujoco_impact_lab.domains.scenes import DM_CONTROL, Player, Scene
from mujoco_impact_lab.domains.watch import Watch

ROBOTS = tuple(
    Scene(DM_CONTROL, *name.split())
    for name in (
        "humanoid stand",
        "quadruped walk",
        "walker walk",
        "cheetah run",
        "dog stand",
    )
)

SECONDS = 10.0
"""Simulated time."""

MOVING = 0.5
"""Part of the time with random actions; then the motors do nothing."""

LYING = 0.2
"""Last part of the time, in which the robots should rest."""

SAMPLES = 250
"""States of a run of which the costs are measured."""


@dataclasses.dataclass(frozen=True)
class Fall:
    """What was seen of one run.

    Attributes:
        warnings: Warnings of MuJoCo.
        deepest: Largest overlap of two geoms [m].
        fastest: Largest velocity of a degree of freedom [m/s, rad/s].
        impacts: Impacts in all.
        lying: Impacts a second in the last part of the time [1/s].
        end: Largest velocity of a degree of freedom at the end [m/s, rad/s].
        energy: Largest energy that the impacts of a step have added [J].
        energy_part: The same over the largest kinetic energy before an impact [-].
        work: Largest work of a step, over what a step may do [-].
        costs: Costs of the steps; None of MuJoCo's own contacts.
    """

    warnings: int
    deepest: float
    fastest: float
    impacts: int
    lying: float
    end: float
    energy: float
    energy_part: float
    work: float
    costs: Costs | None


def falls(
    scene: Scene,
    *,
    restitution: float,
    seeds: int,
    seconds: float = SECONDS,
    samples: int = SAMPLES,
) -> tuple[list[Fall], list[Fall]]:
    """Runs a robot with our contacts, and with MuJoCo's.

    Args:
        scene: The environment.
        restitution: Of our contacts, in [0, 1].
        seeds: Number of runs; their seeds are 0, 1, ...
        seconds: Simulated time of each.
        samples: States of each of which the costs are measured.

    Returns:
        Ours and MuJoCo's, one for each seed.
    """
    ours, stock = scene.ours(restitution), scene.stock()
    every = max(1, round(seconds / ours.model.opt.timestep / samples))
    return (
        [_fall(ours, stock.model, seed, seconds, every) for seed in range(seeds)],
        [_fall(stock, stock.model, seed, seconds, 0) for seed in range(seeds)],
    )


def _fall(
    player: Player, plain: mujoco.MjModel, seed: int, seconds: float, every: int
) -> Fall:
    """Runs a robot; the costs of every `every`-th step are measured, 0: none."""
    model, data = player.model, player.data
    player.reset(seed)
    random = np.random.default_rng(seed)
    watch = Watch(model, data, plain)
    sampler = CostSampler(model, every) if every else None
    warned = data.warning.number.copy()
    steps = round(seconds / model.opt.timestep)
    lying_from, before, work = round(steps * (1 - LYING)), 0, 0.0
    with collected_warnings():
        for step in range(steps):
            if step % player.substeps == 0:
                moves = step < MOVING * steps
                action = random.uniform(-1, 1, model.nu)
                data.ctrl[:] = player.control(action) if moves else 0.0
            watch.before_step()
            if sampler is not None:
                sampler.before_step(data)
            mujoco.mj_step(model, data)
            watch.after_step()
            work = max(work, watch.work)
            if sampler is not None:
                sampler.after_step(watch.work)
            if step < lying_from:
                before = watch.impacts
    return Fall(
        warnings=int((data.warning.number - warned).sum()),
        deepest=watch.deepest,
        fastest=watch.fastest,
        impacts=watch.impacts,
        lying=(watch.impacts - before) / (LYING * seconds),
        end=float(np.abs(data.qvel).max()),
        energy=watch.energy,
        energy_part=watch.energy / max(watch.kinetic, mujoco.mjMINVAL),
        work=work,
        costs=sampler.measure(plain) if sampler is not None else None,
    )
