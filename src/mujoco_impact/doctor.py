"""Checking an installation: versions, the plugin library, and known answers."""

from __future__ import annotations

import dataclasses
import importlib.metadata
import platform
from collections.abc import Callable

import mujoco
import numpy as np

from mujoco_impact import _plugin
from mujoco_impact.errors import ImpactError
from mujoco_impact.runner import run
from mujoco_impact.scene import attach
from mujoco_impact.trajectory import Trajectory

VELOCITY_TOLERANCE = 1e-5
"""Largest error of the known answers, in fractions of the speed of the impact."""

IMPACT_SPEED = 1.0
"""Speed of the known answers [m/s]."""

OPTIONAL = (
    "bokeh",
    "distributed",
    "dm_control",
    "gymnasium",
    "imageio",
    "matplotlib",
    "mujoco-warp",
    "pyarrow",
)
"""Packages of the extras: listed, not required."""

TWO_BALLS = """
<mujoco model="two_balls">
  <option timestep="0.002" gravity="0 0 0"/>
  <default><joint type="slide" axis="1 0 0"/></default>
  <worldbody>
    <body pos="-0.02 0 0"><joint/><geom name="left" size="0.01" mass="0.1"/></body>
    <body pos="0.0051 0 0"><joint/><geom name="right" size="0.01" mass="0.1"/></body>
  </worldbody>
</mujoco>
"""
"""Two equal balls on a rail, 5.1 mm apart; MuJoCo's own contacts do not restitute."""


@dataclasses.dataclass(frozen=True)
class Check:
    """The outcome of one check.

    Attributes:
        name: What was checked.
        passed: Whether it is as it should be.
        found: What was found.
        remedy: What to do if it failed, else empty.
    """

    name: str
    passed: bool
    found: str
    remedy: str = ""


def diagnose() -> tuple[Check, ...]:
    """Runs every check that the ones before it make possible.

    Returns:
        The checks in order; the first failed one is the one to repair.
    """
    checks = [_versions()]
    steps: tuple[Callable[[], Check], ...] = (
        _library,
        _version_match,
        _loading,
        _elastic_impact,
        _inelastic_impact,
    )
    for step in steps:
        checks.append(step())
        if not checks[-1].passed:
            break
    return tuple(checks)


def _versions() -> Check:
    """Lists the versions in use."""
    found = [
        f"mujoco-impact {_version('mujoco-impact')}",
        f"mujoco {mujoco.mj_versionString()}",
        f"numpy {np.__version__}",
        f"Python {platform.python_version()}",
        f"{platform.system()} {platform.machine()}",
    ]
    found += [f"{name} {_version(name)}" for name in OPTIONAL]
    return Check("versions", True, ", ".join(found))


def _library() -> Check:
    """Checks that the plugin library is where it is looked for."""
    try:
        path = _plugin.plugin_path()
    except ImpactError as error:
        return Check("plugin library", False, str(error), "install mujoco-impact anew")
    return Check("plugin library", True, str(path))


def _version_match() -> Check:
    """Checks that the library was built for the MuJoCo that is installed."""
    built, running = _plugin.built_for(), mujoco.mj_versionString()
    found = f"built for MuJoCo {built or '(unknown)'}, running on {running}"
    if built in (None, running):
        return Check("MuJoCo version", True, found)
    return Check("MuJoCo version", False, found, f"pip install mujoco=={built}")


def _loading() -> Check:
    """Checks that MuJoCo takes the plugin."""
    try:
        _plugin.load()
    except ImpactError as error:
        remedy = "install mujoco-impact anew for this version of MuJoCo"
        return Check("plugin registered", False, str(error), remedy)
    return Check("plugin registered", True, f"MuJoCo knows {_plugin.PLUGIN_NAME}")


def _elastic_impact() -> Check:
    """Equal balls swap velocities."""
    return _known_answer("elastic impact", restitution=1.0)


def _inelastic_impact() -> Check:
    """Equal balls leave with (1 - e)/2 and (1 + e)/2 of the speed."""
    return _known_answer("impact with e = 0.5", restitution=0.5)


def _known_answer(name: str, *, restitution: float) -> Check:
    """Checks the velocities after the impact of two equal balls."""
    remedy = "the plugin does not compute impacts: please report this output"
    try:
        trajectory = _impact_of_two_balls(restitution)
    except ImpactError as error:
        return Check(name, False, str(error), remedy)
    expected = np.array([1.0 - restitution, 1.0 + restitution]) / 2.0 * IMPACT_SPEED
    found = trajectory.qvel[-1]
    count = len(trajectory.impacts)
    passed = count == 1 and bool(
        np.all(np.abs(found - expected) <= VELOCITY_TOLERANCE * IMPACT_SPEED)
    )
    text = (
        f"velocities {found[0]:.6f}, {found[1]:.6f} m/s after {count} impact(s), "
        f"expected {expected[0]:.6f}, {expected[1]:.6f} after 1"
    )
    return Check(name, passed, text, "" if passed else remedy)


def _impact_of_two_balls(restitution: float) -> Trajectory:
    """Returns the motion of a ball that meets an equal one at rest."""
    scene = attach(TWO_BALLS, restitution=restitution)
    return run(scene, duration=0.02, qvel=[IMPACT_SPEED, 0.0])


def _version(name: str) -> str:
    """Returns the version of an installed distribution."""
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "(not installed)"
