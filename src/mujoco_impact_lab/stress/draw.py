"""From a seed to a case: every number of the scope is drawn, most on a log scale."""

from __future__ import annotations

import numpy as np

from mujoco_impact_lab.stress.case import FEATURES, INTEGRATORS, LAYOUTS, Case

TIMESTEP = (1e-5, 2e-2)  # [s]
RADIUS = (1e-4, 1e2)  # [m]
DENSITY = (1e2, 2e4)  # [kg/m^3]
MASS_RATIO = (1.0, 1e6)
YOUNG = (1e5, 1e12)  # [Pa]
RESTITUTION = (1e-6, 1.0)
SPEED = (1e-6, 1e3)  # [m/s]
DURATION = (1e-5, 1.0)  # [s]
GAP = (1e-9, 1e-2)  # [m]
COUNT = (2, 200)

STEPS = 24
"""Steps of a case whose impacts are over at once."""

MANY = 0.01
"""Part of the cases that may have more than ten balls."""

MOST_STEPS = 150
"""Bound of the steps of a case whose pulses last."""

FEW, LEAST_OF_MANY = 10, 0.5
"""More balls than a few have at least this restitution: nearly plastic impacts of a
hundred balls take seconds a step, and a sweep of them days."""

LEAST_VISCOUS = 0.05
"""Least restitution of the viscous law."""

MOST_OVERLAP = 0.5
"""Deepest overlap at the start, over the sum of radii."""


def case_of(seed: int) -> Case:
    """Returns the case of a seed; the same on every machine."""
    random = np.random.default_rng(seed)
    layout = str(random.choice(LAYOUTS, p=(0.4, 0.15, 0.15, 0.3)))
    joint = "free" if random.random() < 0.6 else "slides"
    if layout == "row":
        joint = str(random.choice(("free", "slides", "rail", "pendulum")))
    dissipation = "viscous" if random.random() < 0.25 else "bistiffness"
    timestep = logarithmic(random, *TIMESTEP)
    count = _count(random, layout)
    restitution = _restitution(random, dissipation)
    if count > FEW:
        restitution = max(restitution, LEAST_OF_MANY)
    duration = logarithmic(random, *DURATION) if random.random() < 0.4 else None
    return Case(
        seed=seed,
        layout=layout,
        joint=joint,
        count=count,
        radius=logarithmic(random, *RADIUS),
        radius_ratio=float(random.choice((1.0, 1.0, random.uniform(1, 4)))),
        density=logarithmic(random, *DENSITY),
        mass_ratio=1.0 if random.random() < 0.3 else logarithmic(random, *MASS_RATIO),
        young=logarithmic(random, *YOUNG),
        restitution=restitution,
        dissipation=dissipation,
        duration=duration,
        timestep=timestep,
        integrator=str(random.choice(INTEGRATORS)),
        speed=logarithmic(random, *SPEED),
        gap=0.0 if random.random() < 0.5 else logarithmic(random, *GAP),
        overlap=random.uniform(0, MOST_OVERLAP) if random.random() < 0.08 else 0.0,
        features=_features(random, layout, joint),
        steps=_steps(timestep, duration),
    )


def logarithmic(random: np.random.Generator, low: float, high: float) -> float:
    """Returns a number whose logarithm is uniform."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _count(random: np.random.Generator, layout: str) -> int:
    """Returns how many balls: mostly few, now and then up to 200."""
    least, most = COUNT
    if layout == "ring":
        least = 3
    return int(logarithmic(random, least, most if random.random() < MANY else FEW))


def _restitution(random: np.random.Generator, dissipation: str) -> float:
    """Returns e: often 1, sometimes 0, otherwise anything in between."""
    kind = random.random()
    if kind < 0.45:
        return 1.0
    if kind < 0.55 and dissipation == "bistiffness":
        return 0.0
    if kind < 0.8:
        return float(random.uniform(LEAST_VISCOUS, 1.0))
    least = LEAST_VISCOUS if dissipation == "viscous" else RESTITUTION[0]
    return logarithmic(random, least, RESTITUTION[1])


def _features(random: np.random.Generator, layout: str, joint: str) -> tuple[str, ...]:
    """Returns the extras of a scene; none in most."""
    if random.random() < 0.65:
        return ()
    possible = FEATURES if layout == "row" and joint != "free" else FEATURES[-2:]
    count = min(len(possible), 1 + int(random.integers(3)))
    chosen = {possible[i] for i in random.permutation(len(possible))[:count]}
    return tuple(feature for feature in FEATURES if feature in chosen)


def _steps(timestep: float, duration: float | None) -> int:
    """Returns enough steps for the impacts, and for the pulses to be delivered."""
    if duration is None:
        return STEPS
    return int(min(MOST_STEPS, STEPS + 2.5 * duration / timestep))
