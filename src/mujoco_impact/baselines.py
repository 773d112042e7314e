"""MuJoCo's own contacts, as good as they get: the settings we are compared with.

All of them change `solref` and `solimp` of every contact of the scene, use elliptic
friction cones (the edges of a pyramid would each deliver the impulse at low impedance)
and need no plugin. They are the best that is known for rows of touching balls:

* damper: zero stiffness and the damping that reverses the closing speed within one
  step, with an impedance so low that the contacts of a row do not see each other
  (MuJoCo documentation, chapter on restitution, "reflecting damper").
  Gives the sequence of pairwise impacts; Euler and implicitfast only.
* compliant: a spring without damping whose impedance grows with the overlap (after
  the parameters of `newton_cradle.xml` in the MuJoCo repository), made as stiff as the
  timestep allows.
* Hertz-like: the same with a sigmoid impedance fitted so that the force grows as
  overlap^1.5 up to one impact speed, which must be known beforehand.
"""

from __future__ import annotations

import dataclasses
import math

import mujoco

from mujoco_impact.scene import detach
from mujoco_impact.source import Source
from mujoco_impact.specifications import copy_spec

COMPLIANT_STIFFNESS = 0.4
"""K h^2 of the compliant setting: 1e5 1/s^2 at 2 ms."""

_EXACT_DIAGONAL = int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT)


@dataclasses.dataclass(frozen=True)
class HertzLike:
    """Impedance sigmoid that makes MuJoCo's contact force grow as overlap^1.5.

    Attributes:
        d0: Impedance at zero overlap.
        d1: Impedance at the width and beyond.
        width_factor: Width over v0 / sqrt(K), v0 the impact speed.
        midpoint: Midpoint of the sigmoid over the width.
        power: Power of the sigmoid.
        stiffness: K h^2, K the stiffness in `solref` [1/s^2].
    """

    d0: float
    d1: float
    width_factor: float
    midpoint: float
    power: float
    stiffness: float


HERTZ_COARSE = HertzLike(4.19e-3, 1e-2, 1.73, 2.7e-4, 3.36, stiffness=0.1225)
"""Fitted for the timestep of the scene: K = 3.06e4 1/s^2 at 2 ms."""

HERTZ_FINE = HertzLike(4.6e-4, 1e-3, 1.82, 4.2e-4, 4.32, stiffness=0.01)
"""Fitted for a timestep ten times finer: K = 2.5e5 1/s^2 at 0.2 ms."""

FINE_STEPS = 10
"""How many steps of the fine setting replace one of the scene."""


@dataclasses.dataclass(frozen=True)
class Method:
    """One way of computing the impacts of a scene.

    Attributes:
        name: Short name for tables.
        setting: What was set, in MJCF terms.
        spec: The scene with that setting.
        every: Steps of this method in one step of the scene.
    """

    name: str
    setting: str
    spec: mujoco.MjSpec
    every: int = 1


def baselines(
    source: Source, *, impact_speed: float, restitution: float = 1.0
) -> tuple[Method, ...]:
    """Returns the scene under MuJoCo's own contacts: as it is, then tuned.

    Args:
        source: The scene; a plugin instance of ours in it is taken out.
        impact_speed: Closing speed of the impacts to tune for, v0 [m/s].
        restitution: Restitution to tune for; only the damper can follow it.
    """
    plain = detach(source)
    timestep = float(plain.option.timestep)
    return (
        Method("MuJoCo as is", "the contacts of the scene, unchanged", plain),
        damper(plain, timestep, restitution),
        spring(
            plain,
            "MuJoCo compliant",
            stiffness=COMPLIANT_STIFFNESS / timestep**2,
            solimp=(0.0, 0.01, 0.01, 0.5, 2.0),
        ),
        hertz_like(plain, "MuJoCo Hertz-like", HERTZ_COARSE, impact_speed),
        hertz_like(
            plain, "MuJoCo Hertz-like, h/10", HERTZ_FINE, impact_speed, FINE_STEPS
        ),
    )


def damper(plain: mujoco.MjSpec, timestep: float, restitution: float) -> Method:
    """Returns the reflecting damper."""
    spec = copy_spec(plain)
    damping = (1.0 + restitution) / timestep
    _set_contacts(spec, (0.0, -damping), (0.001, 0.001, 0.001, 0.5, 2.0))
    spec.option.enableflags |= _EXACT_DIAGONAL
    setting = f'solref="0 {-damping:.6g}" solimp=".001 .001 .001" diagexact'
    return Method("MuJoCo damper", setting, spec)


def hertz_like(
    plain: mujoco.MjSpec, name: str, shape: HertzLike, speed: float, every: int = 1
) -> Method:
    """Returns the Hertz-like contact for one impact speed [m/s]."""
    stiffness = shape.stiffness / (plain.option.timestep / every) ** 2
    width = shape.width_factor * speed / math.sqrt(stiffness)
    solimp = (shape.d0, shape.d1, width, shape.midpoint, shape.power)
    return spring(plain, name, stiffness=stiffness, solimp=solimp, every=every)


def spring(
    plain: mujoco.MjSpec,
    name: str,
    *,
    stiffness: float,
    solimp: tuple[float, ...],
    every: int = 1,
) -> Method:
    """Returns an undamped spring contact with the given impedance."""
    spec = copy_spec(plain)
    spec.option.timestep = plain.option.timestep / every
    _set_contacts(spec, (-stiffness, 0.0), solimp)
    shown = " ".join(f"{value:.3g}" for value in solimp)
    setting = f'solref="{-stiffness:.3g} 0" solimp="{shown}"'
    return Method(name, setting, spec, every)


def _set_contacts(
    spec: mujoco.MjSpec, solref: tuple[float, float], solimp: tuple[float, ...]
) -> None:
    """Sets the contact parameters of every geom and every pair."""
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    for element in (*spec.geoms, *spec.pairs):
        element.solref = solref
        element.solimp = solimp
