"""Our impacts and MuJoCo's own contacts, over timesteps, integrators and settings."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING

import mujoco

from mujoco_impact import baselines
from mujoco_impact.scene import attach
from mujoco_impact_lab.bench.methods import Candidate, MethodFamily
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP, BenchScene
from mujoco_impact_lab.bench.simulate import MujocoSimulation
from mujoco_impact_lab.bench.truths import Truth

if TYPE_CHECKING:
    from cradle_models.scene import Integrator

OURS = "ours"
DEFAULT = "mujoco-default"

TIMESTEPS = (5e-4, 1e-3, 2e-3, 5e-3, 1e-2)
"""Timesteps of ours and of MuJoCo's usual settings [s]."""

INTEGRATORS: tuple[Integrator, ...] = ("Euler", "implicitfast", "RK4")

FINE_TOLERANCE = 1e-7
"""Of our most accurate setting: finer, the geometry an impact sees frozen decides."""

ELASTIC_STIFFNESS = (1e3, 9e4, 1e6)
"""K of the documented setting [1/s^2]: 1e3 is the example of the documentation."""

COMPLIANT = (
    (1e5, 1e-2, 2e-3),
    (1e6, 1e-2, 1e-3),
    (3e5, 5e-3, 1e-3),
    (1e8, 1e-2, 5e-4),
    (1e8, 1e-3, 1e-4),
)
"""K [1/s^2], width [m], timestep [s]; the last one is MuJoCo's newton_cradle.xml."""

HERTZ_TIMESTEPS = (2e-3, 1e-3, 5e-4, 2e-4, 5e-5, 2e-5)
HERTZ_STIFFNESS = (0.36, 0.1225, 0.04, 0.01)
"""K h^2 of the sweep of the Hertz-like impedance."""

HERTZ_SHAPES = {"coarse": baselines.HERTZ_COARSE, "fine": baselines.HERTZ_FINE}

Change = Callable[[mujoco.MjSpec, BenchScene, Truth], mujoco.MjSpec]


def families() -> tuple[MethodFamily, ...]:
    """Returns the methods that run in MuJoCo, ours first."""
    return (
        MethodFamily(OURS, "mujoco-impact", tuple(_ours())),
        MethodFamily(DEFAULT, "MuJoCo, defaults", tuple(_defaults())),
        MethodFamily(
            "mujoco-elastic", 'MuJoCo, documented solref="-K 0"', tuple(_elastic())
        ),
        MethodFamily(
            "mujoco-damper", "MuJoCo, expert: reflecting damper", tuple(_dampers())
        ),
        MethodFamily(
            "mujoco-compliant", "MuJoCo, expert: compliant", tuple(_compliant())
        ),
        MethodFamily("mujoco-hertz", "MuJoCo, expert: Hertz-like", tuple(_hertz())),
    )


def _candidate(
    method: str,
    setting: str,
    timestep: float,
    change: Change,
    *,
    integrator: Integrator = "Euler",
    quick: bool = False,
    sweep: bool = False,
    lossless_only: bool = False,
) -> Candidate:
    """Returns a candidate that changes the specification of the scene."""

    def build(scene: BenchScene, truth: Truth) -> MujocoSimulation:
        spec = change(scene.spec(timestep, integrator), scene, truth)
        return MujocoSimulation(scene, spec)

    return Candidate(
        method,
        setting,
        timestep,
        integrator,
        build,
        quick=quick,
        sweep=sweep,
        lossless_only=lossless_only,
    )


def _ours() -> list[Candidate]:
    """Returns our impacts under every integrator."""

    def change(spec: mujoco.MjSpec, scene: BenchScene, _: Truth) -> mujoco.MjSpec:
        return attach(spec, restitution=scene.restitution)

    def fine(spec: mujoco.MjSpec, scene: BenchScene, _: Truth) -> mujoco.MjSpec:
        return attach(spec, restitution=scene.restitution, tolerance=FINE_TOLERANCE)

    finest = _candidate(
        OURS, f"tolerance={FINE_TOLERANCE:g}", BASE_TIMESTEP, fine, integrator="RK4"
    )
    return [
        _candidate(
            OURS,
            "defaults",
            timestep,
            change,
            integrator=integrator,
            quick=integrator == "Euler" or timestep == BASE_TIMESTEP,
        )
        for integrator in INTEGRATORS
        for timestep in TIMESTEPS
    ] + [finest]


def _defaults() -> list[Candidate]:
    """Returns MuJoCo's defaults at several timesteps."""
    return [
        _candidate(
            DEFAULT,
            "defaults",
            timestep,
            lambda spec, *_: spec,
            quick=timestep == BASE_TIMESTEP,
        )
        for timestep in TIMESTEPS
    ]


def _elastic() -> list[Candidate]:
    """Returns the documented way to perfect restitution."""

    def change(stiffness: float) -> Change:
        def apply(spec: mujoco.MjSpec, *_: object) -> mujoco.MjSpec:
            for element in (*spec.geoms, *spec.pairs):
                element.solref = (-stiffness, 0.0)
            return spec

        return apply

    return [
        _candidate(
            "mujoco-elastic",
            f'solref="-{stiffness:g} 0"',
            timestep,
            change(stiffness),
            quick=timestep == BASE_TIMESTEP and stiffness == 9e4,
            lossless_only=True,
        )
        for stiffness in ELASTIC_STIFFNESS
        for timestep in TIMESTEPS[:3]
    ]


def _dampers() -> list[Candidate]:
    """Returns the reflecting damper, the only tuned setting that can lose energy."""

    def change(spec: mujoco.MjSpec, scene: BenchScene, _: Truth) -> mujoco.MjSpec:
        return baselines.damper(spec, spec.option.timestep, scene.restitution).spec

    return [
        _candidate(
            "mujoco-damper",
            'solref="0 -(1+e)/h" solimp=".001 .001 .001" diagexact',
            timestep,
            change,
            quick=timestep == BASE_TIMESTEP,
        )
        for timestep in TIMESTEPS
    ]


def _compliant() -> list[Candidate]:
    """Returns springs whose impedance grows with the overlap."""

    def change(stiffness: float, width: float) -> Change:
        def apply(spec: mujoco.MjSpec, *_: object) -> mujoco.MjSpec:
            solimp = (0.0, 0.01, width, 0.5, 2.0)
            return baselines.spring(spec, "", stiffness=stiffness, solimp=solimp).spec

        return apply

    return [
        _candidate(
            "mujoco-compliant",
            f'solref="-{stiffness:g} 0" solimp="0 .01 {width:g}"',
            timestep,
            change(stiffness, width),
            quick=timestep == BASE_TIMESTEP,
            lossless_only=True,
        )
        for stiffness, width, timestep in COMPLIANT
    ]


def _hertz() -> list[Candidate]:
    """Returns the sweep of the Hertz-like impedance; few of it for every scene."""

    def change(shape: baselines.HertzLike) -> Change:
        def apply(spec: mujoco.MjSpec, _: BenchScene, truth: Truth) -> mujoco.MjSpec:
            return baselines.hertz_like(spec, "", shape, truth.speed).spec

        return apply

    recommended = ((2e-3, 0.1225, "coarse"), (2e-4, 0.01, "fine"))
    return [
        _candidate(
            "mujoco-hertz",
            f"{name} sigmoid, K = {factor / timestep**2:.3g} 1/s^2",
            timestep,
            change(dataclasses.replace(shape, stiffness=factor)),
            quick=(timestep, factor, name) in recommended,
            sweep=(timestep, factor, name) not in recommended,
            lossless_only=True,
        )
        for timestep in HERTZ_TIMESTEPS
        for factor in HERTZ_STIFFNESS
        for name, shape in HERTZ_SHAPES.items()
    ]
