"""The scene of a case, with its masses, its timestep, and the state it starts from."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import cradle_models
from mujoco_impact.comparing.compare import attached_scene
from mujoco_impact.errors import ConfigError
from mujoco_impact.runner import initial_data
from mujoco_impact.scene import detach
from mujoco_impact.settings import SETTINGS
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec, copy_spec
from mujoco_impact.starts import settled
from mujoco_impact.stress.variations import INTEGRATORS
from mujoco_impact.sweeping.parameters import ATTACH, BUILDERS, Value
from mujoco_impact.text import closest


@dataclasses.dataclass(frozen=True, eq=False)
class CaseScene:
    """The scene of a case.

    Attributes:
        attached: The scene with our impacts.
        plain: The scene with MuJoCo's contacts.
        law: Settings of the impact law.
        start: What `run` is told of the start: keyframe, positions, velocities.
        duration: Simulated time [s].
    """

    attached: mujoco.MjSpec
    plain: mujoco.MjSpec
    law: dict[str, Any]
    start: dict[str, Any]
    duration: float


def scene_of(case: Mapping[str, Value], folder: Path) -> CaseScene:
    """Returns the scene of a case.

    Args:
        case: All parameters of the case.
        folder: Where files of models are, unless their path says so.

    Raises:
        ImpactError: If there is no such scene, or it does not take a value.
        CradleModelError: If a builder does not take a value.
    """
    spec = read_spec(source_of(case, folder))
    if "timestep" in case:
        spec.option.timestep = case["timestep"]
    if "integrator" in case:
        spec.option.integrator = INTEGRATORS[str(case["integrator"])]
    for geom, mass in _section(case, "mass").items():
        _set_mass(spec, geom, mass)
    given = _section(case, "attach")
    settings = {name: one for name, one in given.items() if name in SETTINGS}
    options = {name: given.get(name) for name in ATTACH if name not in SETTINGS}
    attached, law = attached_scene(spec, options, settings)
    return CaseScene(
        attached=attached,
        plain=detach(attached),
        law=law,
        start=_start(spec, case),
        duration=float(str(case["duration"])),
    )


def source_of(case: Mapping[str, Value], folder: Path) -> Source:
    """Returns the model of a case: MJCF that a builder makes, a file or a name."""
    builder = case.get("scene.builder")
    options = _section(case, "scene")
    if builder is None:
        name = str(options["model"])
        file = folder / name
        # a file of that name comes before a shipped model
        shipped = name in cradle_models.list_models() and not file.is_file()
        return name if shipped else file
    del options["builder"]
    make = BUILDERS[str(builder)]
    try:
        return make(**options)
    except TypeError as error:
        # the names of the arguments have been checked
        shown = ", ".join(f"{name} = {value!r}" for name, value in options.items())
        msg = f"{builder} cannot be made with {shown}: {error}"
        raise ConfigError(msg) from error


def _section(case: Mapping[str, Value], section: str) -> dict[str, Any]:
    """Returns the parameters of a section by the rest of their names."""
    return {
        name.partition(".")[2]: value
        for name, value in case.items()
        if name.startswith(f"{section}.")
    }


def _set_mass(spec: mujoco.MjSpec, name: str, mass: Any) -> None:
    """Sets the mass of a geom [kg]; its inertia is that of its shape."""
    geoms = {geom.name: geom for geom in spec.geoms}
    if name not in geoms:
        msg = f"mass.{name}: the scene has no geom {name!r}{closest(name, geoms)}"
        raise ConfigError(msg)
    geom = geoms[name]
    if geom.parent.explicitinertial:
        msg = (
            f"mass.{name} = {mass:g}: the inertia of body {geom.parent.name!r} is not "
            "that of its geoms, for the scene has an <inertial> there; take it out"
        )
        raise ConfigError(msg)
    geom.mass = mass


def _start(spec: mujoco.MjSpec, case: Mapping[str, Value]) -> dict[str, Any]:
    """Returns what `run` is told of the start."""
    model = compile_spec(copy_spec(spec))
    keys = [key.name for key in spec.keys]
    keyframe: Any = settled(keys, case.get("keyframe"))  # type: ignore[arg-type]
    data = initial_data(model, keyframe=keyframe)
    widths = {
        mujoco.mjtJoint.mjJNT_FREE: (7, 6),
        mujoco.mjtJoint.mjJNT_BALL: (4, 3),
    }
    for column, (state, addresses) in enumerate(
        (("qpos", model.jnt_qposadr), ("qvel", model.jnt_dofadr))
    ):
        for name, value in _section(case, state).items():
            joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
            if joint < 0:
                names = [model.joint(number).name for number in range(model.njnt)]
                msg = f"{state}.{name}: the scene has no joint {name!r}"
                raise ConfigError(msg + closest(name, names))
            width = widths.get(model.jnt_type[joint], (1, 1))[column]
            numbers = np.atleast_1d(np.asarray(value, dtype=np.float64))
            if numbers.shape != (width,):
                msg = f"{state}.{name} = {value}: numbers the joint needs: {width}"
                raise ConfigError(msg)
            begin = int(addresses[joint])
            getattr(data, state)[begin : begin + width] = numbers
    data.qvel[:] *= case["speed_factor"]
    # the keyframe, too: it may set more than the state
    return {
        "keyframe": keyframe,
        "qpos": data.qpos.copy(),
        "qvel": data.qvel.copy(),
    }
