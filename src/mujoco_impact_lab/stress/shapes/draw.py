"""From a seed to a case of shapes: every number of the scope is drawn."""

from __future__ import annotations

import dataclasses

import numpy as np

from mujoco_impact_lab.stress.case import INTEGRATORS
from mujoco_impact_lab.stress.draw import logarithmic
from mujoco_impact_lab.stress.shapes.case import FLOORS, JOINTS, SHAPES, Case, Tree

TIMESTEP = (5e-4, 5e-3)  # [s]
SIZE = (1e-2, 3e-1)  # [m]
DENSITY = (300.0, 8000.0)  # [kg/m^3]
MASS_RATIO = (1.0, 1e3)
PACE = (0.05, 0.7)
CLEARANCE = (1e-3, 0.3)
STEPS = (50, 200)

MOST_TREES, MOST_GEOMS, MOST_LINKS, MOST_MATERIALS = 4, 3, 3, 4

JOINT_ODDS = (0.4, 0.06, 0.06, 0.08, 0.1, 0.08, 0.12, 0.1)
"""How often each of `JOINTS` is drawn."""

SIMPLE = 0.3
"""Part of the cases with one geom per body and its centre in the joint: what their
spin and their momentum must be is known. In free space it is twice as many."""


def case_of(seed: int) -> Case:
    """Returns the case of a seed; the same on every machine."""
    random = np.random.default_rng(seed)
    floor = str(random.choice(FLOORS))
    least = 2 if floor == "none" else 1
    simple = random.random() < (2 * SIMPLE if floor == "none" else SIMPLE)
    weight = 9.81 if random.random() < (0.3 if floor == "none" else 0.8) else 0.0
    restitution = random.choice((0.0, 0.5, 1.0, random.random()))
    return Case(
        seed=seed,
        trees=tuple(
            _tree(random, number, simple=simple)
            for number in range(random.integers(least, MOST_TREES, endpoint=True))
        ),
        floor=floor,
        size=logarithmic(random, *SIZE),
        offset=0.0 if simple else float(random.uniform(0, 1)),
        density=logarithmic(random, *DENSITY),
        mass_ratio=1.0 if random.random() < 0.5 else logarithmic(random, *MASS_RATIO),
        gravity=weight,
        restitution=float(restitution),
        condim=int(random.choice((1, 3, 4, 6))),
        cone=str(random.choice(("pyramidal", "elliptic"))),
        jacobian=str(random.choice(("dense", "sparse"))),
        integrator=str(random.choice(INTEGRATORS)),
        timestep=logarithmic(random, *TIMESTEP),
        pace=logarithmic(random, *PACE),
        spin=float(random.choice((0.0, 0.3, 1.0))),
        clearance=logarithmic(random, *CLEARANCE),
        steps=int(logarithmic(random, *STEPS)),
    )


def case_with_materials(seed: int) -> Case:
    """Returns the case of a seed with what its geoms are made of."""
    materials = np.random.default_rng((seed, 9)).integers(
        1, MOST_MATERIALS, endpoint=True
    )
    return dataclasses.replace(case_of(seed), materials=int(materials))


def _tree(random: np.random.Generator, number: int, *, simple: bool) -> Tree:
    """Returns one tree; a simple one flies freely."""
    joint = "free" if simple else str(random.choice(JOINTS, p=JOINT_ODDS))
    geoms = 1 if simple or random.random() < 0.5 else MOST_GEOMS
    return Tree(
        number=number,
        joint=joint,
        shapes=tuple(
            str(random.choice(SHAPES))
            for _ in range(random.integers(1, geoms, endpoint=True))
        ),
        links=int(random.integers(2, MOST_LINKS + 1)) if "chain" in joint else 1,
    )
