"""The ways in which a scene is run."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import mujoco

from mujoco_impact.ownership import owned_geoms
from mujoco_impact.runner import initial_data
from mujoco_impact.scene import attach
from mujoco_impact.settings import Setting
from mujoco_impact.specifications import compile_spec, copy_spec
from mujoco_impact.starts import Keyframe

TIMESTEPS = (0.1, 0.5, 2.0, 5.0)
"""Timesteps tried, over that of the scene."""

SPEEDS = (0.1, 3.0, 10.0)
"""Speeds at the start tried, over those of the scene."""

RESTITUTIONS = (1.0, 0.5, 0.0)
"""Coefficients of restitution tried, for a scene without the plugin."""

INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "discrete": mujoco.mjtIntegrator.mjINT_DISCRETE,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
}
"""Integrators tried, by name."""


@dataclasses.dataclass(frozen=True)
class Variation:
    """One way of running a scene.

    Attributes:
        name: What is changed.
        timestep: Factor of the timestep.
        speed: Factor of the velocities at the start.
        integrator: Another integrator, None for that of the scene.
        settings: Settings of the impact law beside those of the user.
    """

    name: str
    timestep: float = 1.0
    speed: float = 1.0
    integrator: str | None = None
    settings: Mapping[str, Setting] = dataclasses.field(default_factory=dict)


def variations(spec: mujoco.MjSpec, keyframe: Keyframe = None) -> tuple[Variation, ...]:
    """Returns the ways in which a scene is run."""
    start = initial_data(compile_spec(copy_spec(spec)), keyframe=keyframe)
    ways = [Variation("as it is")]
    ways += [Variation(f"timestep x {f:g}", timestep=f) for f in TIMESTEPS]
    ways += [Variation(f"integrator {name}", integrator=name) for name in INTEGRATORS]
    if start.qvel.any():
        ways += [Variation(f"speeds x {f:g}", speed=f) for f in SPEEDS]
    if not owned_geoms(spec):
        ways += [
            Variation(f"restitution {e:g}", settings={"restitution": e})
            for e in RESTITUTIONS
        ]
        ways += [Variation("pulses of 2 ms", settings={"duration": 2e-3})]
    return tuple(ways)


def varied(
    spec: mujoco.MjSpec, variation: Variation, settings: Mapping[str, Setting]
) -> mujoco.MjSpec:
    """Returns the scene of a variation, with the plugin."""
    scene = copy_spec(spec)
    scene.option.timestep = spec.option.timestep * variation.timestep
    if variation.integrator is not None:
        scene.option.integrator = INTEGRATORS[variation.integrator]
    if owned_geoms(scene):
        return scene
    law: dict[str, Any] = {**settings, **variation.settings}
    return attach(scene, **law)
