"""Reading a scene from wherever it is: file, XML text, spec or shipped name."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TypeAlias

import mujoco

import cradle_models
from mujoco_impact import _plugin
from mujoco_impact.errors import SceneError
from mujoco_impact.files import quoted, read_text
from mujoco_impact.instances import check_named
from mujoco_impact.specifications import copy_spec, one_line
from mujoco_impact.text import closest

LONGEST_PATH = 300
"""Most characters of a path in a message: it may be any text."""

LARGEST_MODEL = 256_000_000
"""Most bytes of a model file, without its assets."""

UNNAMED = "MuJoCo Model"
"""What MuJoCo calls a model without a name; it is then called as its file."""

_ARCHIVES = (".mjz", ".zip")
"""Endings of model files that are no text."""

_INCLUDE = re.compile(r"<include\b[^>]*\bfile\s*=\s*[\"']([^\"']+)")

_NOT_XML = re.compile(
    r"XML parse error .*XML_ERROR_.*Line number=(\d+)(?:: XMLElement name=(\S+))?"
)

Source: TypeAlias = str | os.PathLike[str] | mujoco.MjSpec
"""A path of an MJCF or URDF file, the name of a shipped model, XML text, or a
specification."""


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
        return _read_file(_shipped(source) or Path(source))
    msg = (
        f"a scene must be a path, the name of a shipped model, XML text or a "
        f"mujoco.MjSpec, got {type(source).__name__}"
    )
    raise SceneError(msg)


def _shipped(name: str | os.PathLike[str]) -> Path | None:
    """Returns the file of a shipped model; a file of that name comes first."""
    if name not in cradle_models.list_models() or _is_file(Path(name)):
        return None
    return cradle_models.model_path(str(name))


def _parse(xml: str) -> mujoco.MjSpec:
    """Returns the specification of XML text."""
    try:
        return mujoco.MjSpec.from_string(xml.lstrip("\ufeff \t\r\n"))
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot read the XML text: {_reason(error)}"
        raise SceneError(msg) from error


def _read_file(path: Path) -> mujoco.MjSpec:
    """Returns the specification in a file."""
    if path.suffix.lower() == ".mjb":
        msg = f"{path} is a compiled model: give the MJCF file it was made from"
        raise SceneError(msg)
    if not _is_file(path):
        shown = quoted(str(path), longest=LONGEST_PATH)
        models = closest(path.name, cradle_models.list_models())
        msg = f"there is no model file {shown} and no shipped model of that name"
        raise SceneError(msg + models)
    if path.suffix.lower() not in _ARCHIVES:
        _check_text(path)
    try:
        # absolute: MuJoCo looks for assets from the working directory of later calls
        spec = mujoco.MjSpec.from_file(str(path.resolve()))
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot read {path}: {_reason(error)}"
        raise SceneError(msg) from error
    if spec.modelname == UNNAMED:
        spec.modelname = path.stem
    return spec


def _reason(error: BaseException) -> str:
    """Returns why MuJoCo cannot read a model."""
    text = one_line(error)
    wrong = _NOT_XML.search(text)
    if wrong is None:
        return text
    where, what = wrong.groups()
    element = f" in <{what}>" if what else ""
    return f"it is no MJCF or URDF, for line {where} is not well-formed XML{element}"


def _is_file(path: Path) -> bool:
    """Returns whether a path is a file that can be looked at."""
    try:
        return path.is_file()
    except OSError:  # too long, or in a folder without permission
        return False


def _check_text(path: Path) -> None:
    """Raises SceneError if a model, or what it includes, is not text in UTF-8.

    MuJoCo reads any bytes, and Python fails later, at the first name.
    """
    seen = set[Path]()
    waiting = [path]
    while waiting:
        file = waiting.pop()
        if file in seen or not _is_file(file):
            continue  # MuJoCo says what is missing, or includes itself
        seen.add(file)
        text = read_text(file, what="a model", error=SceneError, limit=LARGEST_MODEL)
        for name in _INCLUDE.findall(text):
            waiting += [path.parent / name, file.parent / name]
