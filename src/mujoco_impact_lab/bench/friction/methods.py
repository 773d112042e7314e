"""Our impacts and MuJoCo's own contacts, on scenes with friction."""

from __future__ import annotations

import dataclasses
import itertools
import math
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Protocol

import mujoco
import numpy as np

from mujoco_impact import baselines
from mujoco_impact.errors import SimulationError
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.runner import load_model
from mujoco_impact.scene import attach
from mujoco_impact_lab.bench.friction.scene import FrictionScene, Motion
from mujoco_impact_lab.bench.mujoco_methods import (
    DEFAULT,
    FINE_TOLERANCE,
    HERTZ_SHAPES,
    INTEGRATORS,
    OURS,
    TIMESTEPS,
)
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP

if TYPE_CHECKING:
    from cradle_models.scene import Integrator

FINE_TIMESTEPS = (2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
"""Timesteps of MuJoCo's tuned contacts [s], down to a twentieth of ours."""

HELPERS = ((1.0, 0), (10.0, 0), (10.0, 5))
"""impratio, and iterations of the solver that takes slip away (noslip)."""

SPRING_STIFFNESS = (0.04, 0.16, 1.0)
"""K h^2 of springs with losses, K in `solref`."""

IMPEDANCES = (0.95, 0.01)
"""With a low impedance the contacts of one impact hardly see each other."""

HERTZ_STIFFNESS = (1.0, 0.36, 0.1225)
"""K h^2 of the Hertz-like impedance."""

HERTZ_LOSSES = ((False, 1.0), (True, 1.0), (True, 10.0))
"""Whether it has the damping of the restitution, and impratio."""


class FrictionSimulation(Protocol):
    """One way of simulating one scene."""

    def record(self) -> list[Motion]:
        """Runs once from every start; not timed."""

    def run_time(self) -> float:
        """Runs once from every start and returns the time of the processor [s].

        On an idle machine that is wall-clock time: everything runs on one thread.
        """


@dataclasses.dataclass(frozen=True)
class Setting:
    """One method with one setting: one point of a chart.

    Attributes:
        method: Name of the method.
        words: What was set.
        timestep: Timestep [s].
        integrator: Integrator.
        build: Makes the simulation of a scene.
        quick: Whether `--quick` measures it.
    """

    method: str
    words: str
    timestep: float
    integrator: str
    build: Callable[[FrictionScene], FrictionSimulation]
    quick: bool = False


class MujocoMotions:
    """A scene in MuJoCo, with our impacts or with its own contacts."""

    def __init__(self, scene: FrictionScene, spec: mujoco.MjSpec) -> None:
        """Compiles the scene.

        Args:
            scene: What the specification simulates.
            spec: The scene with its contacts set.
        """
        self.model = load_model(spec)
        self._steps = round(scene.duration / float(self.model.opt.timestep))
        self._data = mujoco.MjData(self.model)
        self._starts = list[mujoco.MjData]()
        for qpos, qvel in scene.starts:
            start = mujoco.MjData(self.model)
            start.qpos[:], start.qvel[:] = qpos, qvel
            self._starts.append(start)

    def record(self) -> list[Motion]:
        """Runs once from every start, with a sample every step.

        Raises:
            SimulationError: If MuJoCo gives a warning.
        """
        return list(map(self._motion, self._starts))

    def run_time(self) -> float:
        """Runs by one call into MuJoCo for each start; not counted: the copy of it."""
        spent = 0.0
        with collected_warnings():
            for start in self._starts:
                mujoco.mj_copyData(self._data, self.model, start)
                begin = time.process_time()
                mujoco.mj_step(self.model, self._data, nstep=self._steps)
                spent += time.process_time() - begin
        return spent

    def _motion(self, start: mujoco.MjData) -> Motion:
        model, data = self.model, self._data
        mujoco.mj_copyData(data, model, start)
        count = self._steps + 1
        times = np.arange(count, dtype=np.float64) * float(model.opt.timestep)
        qpos = np.tile(data.qpos, (len(times), 1))
        qvel = np.tile(data.qvel, (len(times), 1))
        with collected_warnings() as messages:
            for step in range(1, len(times)):
                mujoco.mj_step(model, data)
                if messages:
                    msg = f"MuJoCo gave a warning before {times[step]:.4g} s: "
                    raise SimulationError(msg + messages[0].strip(), time=times[step])
                qpos[step], qvel[step] = data.qpos, data.qvel
        return Motion(times, qpos, qvel)


Change = Callable[[mujoco.MjSpec, FrictionScene], mujoco.MjSpec]


def _setting(
    method: str,
    words: str,
    timestep: float,
    change: Change,
    *,
    integrator: Integrator = "Euler",
    quick: bool = False,
) -> Setting:
    def build(scene: FrictionScene) -> MujocoMotions:
        return MujocoMotions(scene, change(scene.spec(timestep, integrator), scene))

    return Setting(method, words, timestep, integrator, build, quick)


def mujoco_settings(scene: FrictionScene) -> Iterator[Setting]:
    """Yields everything that runs in MuJoCo, ours first."""
    yield from _ours()
    for timestep in (*TIMESTEPS, 2e-4, 1e-4):
        yield _setting(
            DEFAULT,
            "defaults",
            timestep,
            lambda spec, _: spec,
            quick=timestep == BASE_TIMESTEP,
        )
    yield from _dampers()
    yield from _springs(damping_ratio(scene.restitution))
    if scene.name == "break":
        # the one scene where balls share an impact, which is what it is fitted for
        yield from _hertz(damping_ratio(scene.restitution))


def _ours() -> Iterator[Setting]:
    """Yields our impacts under every integrator."""

    def change(spec: mujoco.MjSpec, scene: FrictionScene) -> mujoco.MjSpec:
        return attach(spec, restitution=scene.restitution, speed=2 * scene.speed)

    def fine(spec: mujoco.MjSpec, scene: FrictionScene) -> mujoco.MjSpec:
        return attach(
            spec,
            restitution=scene.restitution,
            speed=2 * scene.speed,
            tolerance=FINE_TOLERANCE,
        )

    for integrator, timestep in itertools.product(INTEGRATORS, TIMESTEPS):
        yield _setting(
            OURS,
            "defaults",
            timestep,
            change,
            integrator=integrator,
            quick=timestep == BASE_TIMESTEP,
        )
    words = f"tolerance={FINE_TOLERANCE:g}"
    yield _setting(OURS, words, BASE_TIMESTEP, fine, integrator="RK4")


def damping_ratio(restitution: float) -> float:
    """Returns the damping ratio of a spring that gives a restitution.

    e = exp(-pi zeta / sqrt(1 - zeta^2)), half a period of a damped spring.
    """
    loss = -math.log(restitution)
    return loss / math.hypot(math.pi, loss)


def _helped(spec: mujoco.MjSpec, impratio: float, noslip: int) -> mujoco.MjSpec:
    """Returns the scene with what MuJoCo has against slip."""
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = impratio
    spec.option.noslip_iterations = noslip
    return spec


def _words(impratio: float, noslip: int) -> str:
    return f"elliptic, impratio {impratio:g}, noslip {noslip}"


def _dampers() -> Iterator[Setting]:
    """Yields the damper that reverses the closing speed within one step."""
    for timestep, helpers in itertools.product(FINE_TIMESTEPS, HELPERS):

        def change(
            spec: mujoco.MjSpec,
            scene: FrictionScene,
            helpers: tuple[float, int] = helpers,
        ) -> mujoco.MjSpec:
            timestep = spec.option.timestep
            damped = baselines.damper(spec, timestep, scene.restitution).spec
            return _helped(damped, *helpers)

        yield _setting(
            "mujoco-damper",
            f'solref="0 -(1+e)/h" solimp=".001 .001 .001", {_words(*helpers)}',
            timestep,
            change,
            quick=timestep == BASE_TIMESTEP and helpers == HELPERS[0],
        )


def _springs(ratio: float) -> Iterator[Setting]:
    """Yields springs and dampers, b = 2 zeta sqrt(k)."""
    for timestep, factor, impedance, helpers in itertools.product(
        FINE_TIMESTEPS, SPRING_STIFFNESS, IMPEDANCES, HELPERS
    ):
        stiffness = factor / timestep**2
        solref = (-stiffness, -2 * ratio * math.sqrt(stiffness))

        def change(
            spec: mujoco.MjSpec,
            _: FrictionScene,
            solref: tuple[float, float] = solref,
            impedance: float = impedance,
            helpers: tuple[float, int] = helpers,
        ) -> mujoco.MjSpec:
            for geom in spec.geoms:
                geom.solref = solref
                geom.solimp = (impedance, impedance, 0.001, 0.5, 2.0)
            # the mass that a contact moves, rather than an estimate of it
            spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_DIAGEXACT
            return _helped(spec, *helpers)

        yield _setting(
            "mujoco-compliant",
            f'solref="{_two(*solref)}" solimp="{impedance:g} {impedance:g}" diagexact, '
            f"{_words(*helpers)}",
            timestep,
            change,
            quick=(timestep, factor, impedance) == (BASE_TIMESTEP, 0.16, 0.01)
            and helpers == HELPERS[1],
        )


def _hertz(ratio: float) -> Iterator[Setting]:
    """Yields contacts whose force grows as overlap^1.5, without and with losses."""
    for timestep, factor, (name, shape), (damped, impratio) in itertools.product(
        FINE_TIMESTEPS, HERTZ_STIFFNESS, HERTZ_SHAPES.items(), HERTZ_LOSSES
    ):
        stiffness = factor / timestep**2
        # the ratio of a spring and a damper of one impedance, whatever that is
        damping = 2 * ratio * math.sqrt(stiffness) if damped else 0.0
        fitted = dataclasses.replace(shape, stiffness=factor)
        solref = (-stiffness, -damping)

        def change(
            spec: mujoco.MjSpec,
            scene: FrictionScene,
            shape: baselines.HertzLike = fitted,
            solref: tuple[float, float] = solref,
            impratio: float = impratio,
        ) -> mujoco.MjSpec:
            hertz = baselines.hertz_like(spec, "", shape, scene.speed).spec
            for geom in hertz.geoms:
                geom.solref = solref
            return _helped(hertz, impratio, 0)

        yield _setting(
            "mujoco-hertz",
            f'{name} sigmoid, solref="{_two(*solref)}", {_words(impratio, 0)}',
            timestep,
            change,
            quick=(timestep, factor, name) == (BASE_TIMESTEP, 0.1225, "coarse")
            and not damped,
        )


def _two(stiffness: float, damping: float) -> str:
    """Returns solref in three digits."""
    return f"{stiffness:.3g} {damping:.3g}"
