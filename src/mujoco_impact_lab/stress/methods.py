"""The ways of computing the impacts of a case: ours, and MuJoCo's contacts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco

from mujoco_impact.baselines import damper
from mujoco_impact.depth import DEPTH, ROUNDING, SOFT
from mujoco_impact.scene import attach
from mujoco_impact_lab.stress.case import Case
from mujoco_impact_lab.stress.layouts import Balls

OURS = "mujoco-impact"
DEFAULTS = "MuJoCo as is"
TUNED = "MuJoCo damper"
METHODS = (OURS, DEFAULTS, TUNED)

SIGHT = 1.25
"""Gap of the owned geoms over what the fastest ball travels in a step."""

FASTEST = 2.5
"""Fastest ball after an impact over the first closing speed: 2 for a light one."""

LEAST_DEPTH, MOST_DEPTH = 0.01, 0.5
"""Depth of the owned geoms over the smallest radius, where it is not the default."""


def model_of(
    method: str, case: Case, xml: str, balls: Balls, *, tolerance: float | None = None
) -> mujoco.MjModel:
    """Returns the model of a case under a method.

    Args:
        method: Of `METHODS`.
        case: The case.
        xml: Its scene.
        balls: Its balls, or an image of them.
        tolerance: Of our impact law; None for the default.
    """
    spec = mujoco.MjSpec.from_string(xml)
    if method == OURS:
        return _ours(spec, case, balls, tolerance).compile()
    return _BUILDERS[method](spec, case).compile()


def depth_of(case: Case, balls: Balls) -> float:
    """Returns the depth that a user would give the scene [m].

    The default where pulses come at once, unless balls overlap at the start; otherwise
    what they overlap during a pulse, within bounds. Deeper overlaps are MuJoCo's.
    """
    if case.duration is None and case.integrator != "RK4" and case.overlap == 0:
        return ROUNDING if case.young < SOFT else DEPTH
    radius = float(balls.radius.min())
    # two geoms add their depths
    wanted = case.pulse_overlap * FASTEST / 2
    return min(max(LEAST_DEPTH * radius, wanted), MOST_DEPTH * radius)


def gap_of(case: Case, balls: Balls) -> float:
    """Returns a gap that shows every impact a step before it happens [m]."""
    travel = SIGHT * FASTEST * case.speed * case.timestep
    return max(travel, 0.5 * float(balls.radius.min()))


def _ours(
    spec: mujoco.MjSpec, case: Case, balls: Balls, tolerance: float | None
) -> mujoco.MjSpec:
    """The plugin, in two instances if the case asks for it."""
    settings: dict[str, Any] = {
        "gap": gap_of(case, balls),
        "depth": depth_of(case, balls),
        "restitution": case.restitution,
        "dissipation": case.dissipation,
        "young": case.young,
        # these scenes judge the normal impulses; those of shapes have friction
        "friction": "none",
    }
    if case.duration is not None:
        settings["duration"] = case.duration
    if tolerance is not None:
        settings["tolerance"] = tolerance
    names = [geom.name for geom in spec.geoms]
    if "two instances" not in case.features:
        return attach(spec, geoms=names, **settings)
    half = len(names) // 2
    first = attach(spec, geoms=names[:half], name="first", **settings)
    return attach(first, geoms=names[half:], name="second", **settings)


def _defaults(spec: mujoco.MjSpec, _case: Case) -> mujoco.MjSpec:
    """MuJoCo's contacts as they come."""
    return spec


def _tuned(spec: mujoco.MjSpec, case: Case) -> mujoco.MjSpec:
    """The best setting known that holds for any impact speed."""
    return damper(spec, case.timestep, case.restitution).spec


_BUILDERS: dict[str, Callable[[mujoco.MjSpec, Case], mujoco.MjSpec]] = {
    DEFAULTS: _defaults,
    TUNED: _tuned,
}
