"""The motions whose single steps are timed."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import partial

import mujoco

import cradle_models
from mujoco_impact.scene import attach, detach
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import copy_spec
from mujoco_impact_lab.bench.library import load_library

BEFORE_IMPACT = 0.2
"""A ball let go at 30 degrees is still far from the row [s]."""

ALONE_GAP, ALONE_RELEASE = 0.2, 10.0
"""Gap [m] and release [deg] of a row whose balls never meet."""

EMPTY_PLUGIN = "mujoco_impact.empty"
"""Plugin of the library that does nothing (plugin/bench/empty_plugin.cc)."""

Change = Callable[[mujoco.MjSpec], mujoco.MjSpec]


@dataclasses.dataclass(frozen=True)
class StepCase:
    """A motion whose single steps are timed.

    Attributes:
        title: What moves.
        balls: Number of balls.
        make: Makes the scene, in MJCF.
        longest: Longest motion that is worth its time [s].
        rounds: Times as many rounds as of a long motion: few steps need more.
        plugin: Whose overhead is measured: adds it to the floor. None: ours.
    """

    title: str
    balls: int
    make: Callable[[], str]
    longest: float = 20.0
    rounds: int = 1
    plugin: Change | None = None

    def specs(self) -> tuple[mujoco.MjSpec, mujoco.MjSpec]:
        """Returns the scene with the plugin, and the floor."""
        attached = attach(read_spec(self.make()))
        bare = floor(attached)
        return attached if self.plugin is None else self.plugin(copy_spec(bare)), bare


def floor(attached: mujoco.MjSpec) -> mujoco.MjSpec:
    """Returns a scene without the plugin, in which the same contacts are detected."""
    bare = detach(attached)
    for geom, owned in zip(bare.geoms, attached.geoms, strict=True):
        geom.margin, geom.gap = owned.margin, owned.gap
    return bare


def add_empty_plugin(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Adds the plugin that does nothing, with a sensor as ours has one."""
    load_library()
    spec.activate_plugin(EMPTY_PLUGIN)
    spec.add_plugin(name="empty", plugin_name=EMPTY_PLUGIN, active=True)
    sensor = spec.add_sensor(name="empty", type=mujoco.mjtSensor.mjSENS_PLUGIN)
    sensor.plugin.active = True
    sensor.plugin.name = "empty"
    sensor.plugin.plugin_name = EMPTY_PLUGIN
    return spec


def step_cases(*, library: bool) -> Sequence[StepCase]:
    """Returns all motions.

    Args:
        library: Whether the library is there, which holds the empty plugin.
    """
    rows = (3, 5, 50, 200, 1000)
    cases = [
        *(_swinging(count) for count in rows),
        *(_before_impact(count) for count in rows),
        StepCase(
            "10 x 10 lattice, corner hit",
            100,
            partial(cradle_models.lattice, 10, 10, released="corner"),
            longest=2.0,
        ),
        StepCase(
            "1000 free balls, two collide",
            1000,
            partial(cradle_models.free_balls, 1000),
            longest=0.3,
        ),
        _alone(5),
        _alone(50),
    ]
    if library:
        cases.append(_alone(5, plugin=add_empty_plugin, what="empty plugin"))
    return cases


def _swinging(count: int) -> StepCase:
    """Returns a row that one ball hits; of long rows the first impact only."""
    make = partial(cradle_models.row, "A" * count)
    title = f"{count} swinging balls"
    return StepCase(title, count, make, longest=20.0 if count <= 50 else 0.4)


def _before_impact(count: int) -> StepCase:
    """Returns the same row while the ball is on its way."""
    make = partial(cradle_models.row, "A" * count)
    title = f"{count} balls, nothing closes"
    # short rows are over in half a millisecond, in which anything may happen
    rounds = max(3, min(40, 1000 // count))
    return StepCase(title, count, make, longest=BEFORE_IMPACT, rounds=rounds)


def _alone(
    count: int, *, plugin: Change | None = None, what: str = "no contact"
) -> StepCase:
    """Returns a row whose balls never meet."""
    make = partial(cradle_models.row, "A" * count, gap=ALONE_GAP, release=ALONE_RELEASE)
    title = f"{count} balls, {what}"
    return StepCase(title, count, make, longest=5.0, plugin=plugin)
