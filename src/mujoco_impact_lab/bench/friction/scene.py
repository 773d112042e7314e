"""What a scene with friction is.

It is an MJCF scene of free bodies, and one or more starts of it: positions and
velocities as MuJoCo has them. Other engines read shapes and masses from the compiled
scene.
"""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from mujoco_impact.source import read_spec
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.scenes import BASE_TIMESTEP
from mujoco_impact_lab.bench.truths import rms

if TYPE_CHECKING:
    from cradle_models.scene import Integrator

TABLES = Path(__file__).parents[4] / "tests" / "law" / "friction"
"""Truth tables: Hertz contacts with Coulomb friction, integrated by Radau at 1e-9. The
laboratory runs in a clone, which has them."""


@dataclasses.dataclass(frozen=True, eq=False)
class Motion:
    """A motion of free bodies, in MuJoCo's coordinates.

    Attributes:
        time: Times [s], shape (t,).
        qpos: Position and quaternion (w, x, y, z) of each body, shape (t, 7 n).
        qvel: Velocity, and spin in the frame of the body, shape (t, 6 n).
    """

    time: Array
    qpos: Array
    qvel: Array


@dataclasses.dataclass(frozen=True, eq=False)
class FrictionScene:
    """Free bodies with Coulomb friction, and what becomes of them.

    Attributes:
        name: Short name.
        title: What it is, and what its error is, for headings.
        xml: The scene, with MuJoCo's own contacts.
        starts: `qpos` and `qvel` of each start.
        outcome: What of a motion is compared with the truth, in fractions, shape (k,);
            the norm of a difference is an error.
        truth: The true outcome of each start, shape (starts, k).
        friction: Coefficient of Coulomb friction of every contact.
        restitution: Restitution of every contact.
        duration: Simulated time of each start [s].
        speed: Speed of the impacts [m/s].
        plane: Axes of the plane in which all moves; None if it moves in space.
        accuracy: Error of the truth: what is nearer counts as that near.
    """

    name: str
    title: str
    xml: str
    starts: tuple[tuple[Array, Array], ...]
    outcome: Callable[[Motion], Array]
    truth: Array
    friction: float
    restitution: float
    duration: float
    speed: float
    plane: tuple[int, int] | None = None
    accuracy: float = 0.0

    def spec(
        self, timestep: float = BASE_TIMESTEP, integrator: Integrator = "Euler"
    ) -> mujoco.MjSpec:
        """Returns the scene with MuJoCo's own contacts.

        Args:
            timestep: Timestep [s].
            integrator: Integrator as MJCF spells it.
        """
        spec = read_spec(self.xml)
        spec.option.timestep = timestep
        spec.option.integrator = _INTEGRATORS[integrator]
        return spec

    def error(self, motions: Sequence[Motion]) -> float:
        """Returns how far the motions from all starts are from the truth, RMS.

        No less than the accuracy of the truth.
        """
        found = np.array([self.outcome(motion) for motion in motions])
        error = rms(np.linalg.norm(found - self.truth, axis=1))
        # not max(), which drops nan
        return error if not error < self.accuracy else self.accuracy


_INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
}


def free_bodies(bodies: str, friction: float) -> str:
    """Returns the MJCF of bodies without gravity."""
    return f"""<mujoco>
  <option gravity="0 0 0"/>
  <default><geom friction="{friction}"/></default>
  <worldbody>{bodies}</worldbody>
</mujoco>"""


def truth_table(name: str) -> list[dict[str, str]]:
    """Returns the rows of a truth table."""
    with (TABLES / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(row: dict[str, str], names: str) -> Array:
    """Returns numbers of a row by their names."""
    return np.array([float(row[name]) for name in names.split()])
