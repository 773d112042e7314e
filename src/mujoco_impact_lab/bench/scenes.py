"""The scenes of the benchmark: rows of steel balls that touch, or nearly."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import mujoco

import cradle_models
from mujoco_impact.errors import SceneError
from mujoco_impact.reference import Chain, release_state
from mujoco_impact.source import read_spec
from mujoco_impact.trajectory import Array

if TYPE_CHECKING:
    from cradle_models.scene import Integrator

BASE_TIMESTEP = 0.002
"""Timestep of the runs that all run times are compared with: MuJoCo's default [s]."""

VELOCITY_DELAY = 0.1
"""Time after first contact at which the velocities are read [s]."""


@dataclasses.dataclass(frozen=True)
class BenchScene:
    """A row of balls, the left ones of which are let go at 30 degrees.

    Attributes:
        name: Short name.
        title: What it is, for headings.
        pattern: Balls A (115 g, 30 mm) and B (230 g, 38.1 mm), left to right.
        released: Number of balls let go.
        gap: Gap between hanging neighbours in the simulation [m]; negative: overlap.
        true_gap: Gap in the reference [m].
        restitution: Restitution of every impact.
        strings: Whether free balls hang on two strings each, instead of on hinges.
        swings: Whether the angles over the whole run have a reference; if not, only
            the velocities after the first impact have.
        sweep: Whether long sweeps of settings are worth their time here.
        duration: Simulated time [s].
    """

    name: str
    title: str
    pattern: str
    released: int = 1
    gap: float = 0.0
    true_gap: float = 0.0
    restitution: float = 1.0
    strings: bool = False
    swings: bool = True
    sweep: bool = False
    duration: float = 3.0

    @property
    def is_row(self) -> bool:
        """Whether the balls are pendulums on hinges, with one angle each."""
        return not self.strings

    def chain(self) -> Chain:
        """Returns the row that the reference is computed for."""
        return Chain.of(cradle_models.balls(self.pattern), gap=self.true_gap)

    def start(self) -> tuple[Array, Array]:
        """Returns angles [rad] and velocities [rad/s] at the start, shape (n,)."""
        return release_state(self.chain(), RELEASE, self.released)

    def spec(
        self, timestep: float = BASE_TIMESTEP, integrator: Integrator = "Euler"
    ) -> mujoco.MjSpec:
        """Returns the scene with MuJoCo's own contacts; keyframe `release` starts it.

        Args:
            timestep: Timestep [s].
            integrator: Integrator as MJCF spells it.
        """
        make = cradle_models.two_string if self.strings else cradle_models.row
        xml = make(
            self.pattern,
            released=self.released,
            release=RELEASE,
            gap=self.gap,
            timestep=timestep,
            integrator=integrator,
            name=self.name,
        )
        return read_spec(xml)


RELEASE = 30.0
"""Angle by which balls are lifted [deg]."""

_SCENES = (
    BenchScene("S1", "3 touching balls", "AAA", sweep=True),
    BenchScene("S2", "5 touching balls", "AAAAA", sweep=True),
    BenchScene("S3", "5 touching balls, 2 released", "AAAAA", released=2, sweep=True),
    BenchScene("S4", "3 touching balls, the first of double mass", "BAA", sweep=True),
    BenchScene("S5", "50 touching balls", "A" * 50, swings=False, sweep=True),
    BenchScene(
        "strings", "5 balls on two strings each", "AAAAA", strings=True, swings=False
    ),
    BenchScene("gaps", "5 balls, gaps of 0.1 mm", "AAAAA", gap=1e-4, true_gap=1e-4),
    BenchScene("overlap", "5 balls that overlap by 1 um at rest", "AAAAA", gap=-1e-6),
    BenchScene(
        "e09",
        "5 touching balls, restitution 0.9",
        "AAAAA",
        restitution=0.9,
        swings=False,
    ),
)

SCENES = {scene.name: scene for scene in _SCENES}
"""Every scene by name."""


def choose_scenes(names: list[str] | None) -> tuple[BenchScene, ...]:
    """Returns the scenes of the given names, all of them for None.

    Raises:
        SceneError: If a name is unknown.
    """
    for name in names or ():
        if name not in SCENES:
            msg = f"there is no scene {name!r} (available: {', '.join(SCENES)})"
            raise SceneError(msg)
    return _SCENES if names is None else tuple(SCENES[name] for name in names)
