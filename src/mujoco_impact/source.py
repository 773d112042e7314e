"""Reading a scene from wherever it is: file, XML text, spec or shipped name."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeAlias

import mujoco

from mujoco_impact import _plugin
from mujoco_impact.errors import SceneError
from mujoco_impact.instances import check_named
from mujoco_impact.specifications import copy_spec, one_line

Source: TypeAlias = str | os.PathLike[str] | mujoco.MjSpec
"""A path of an MJCF or URDF file, XML text, or a specification."""


def read_spec(source: Source) -> mujoco.MjSpec:
    """Returns the scene as a specification of its own.

    Text that starts with "<" is XML, any other text is a path. Included files and
    assets of a path are found from the directory of that file. A specification
    is copied, so that the caller's stays as it is.

    Args:
        source: Path, XML text or specification.

    Raises:
        SceneError: If there is no such file, or MuJoCo cannot read the scene.
        PluginError: If the plugin of this package cannot be loaded.
    """
    # a scene may already name the plugin, and is then unreadable without it
    _plugin.load()
    spec = _spec_of(source)
    check_named(spec)
    # MuJoCo has read a file or a text for us alone
    return copy_spec(spec) if spec is source else spec


def _spec_of(source: Source) -> mujoco.MjSpec:
    """Returns the specification of a source, which may be the caller's own."""
    if isinstance(source, mujoco.MjSpec):
        return source
    if isinstance(source, str) and source.lstrip("\ufeff \t\r\n").startswith("<"):
        return _parse(source)
    if isinstance(source, str | os.PathLike):
        return _read_file(Path(source))
    msg = (
        f"a scene must be a path, XML text or a mujoco.MjSpec, "
        f"got {type(source).__name__}"
    )
    raise SceneError(msg)


def _parse(xml: str) -> mujoco.MjSpec:
    """Returns the specification of XML text."""
    try:
        return mujoco.MjSpec.from_string(xml.lstrip("\ufeff \t\r\n"))
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot read the XML text: {one_line(error)}"
        raise SceneError(msg) from error


def _read_file(path: Path) -> mujoco.MjSpec:
    """Returns the specification in a file."""
    if path.suffix.lower() == ".mjb":
        msg = f"{path} is a compiled model: give the MJCF file it was made from"
        raise SceneError(msg)
    if not path.is_file():
        msg = f"there is no model file {str(path)!r}"
        raise SceneError(msg)
    try:
        # absolute: MuJoCo looks for assets from the working directory of later calls
        return mujoco.MjSpec.from_file(str(path.resolve()))
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot read {path}: {one_line(error)}"
        raise SceneError(msg) from error
