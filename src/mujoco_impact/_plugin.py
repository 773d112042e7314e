"""Registering the engine plugin with MuJoCo.

`load` is also the target of the `mujoco.plugins` entry point, which MuJoCo 4.0
calls while it is itself being imported: this module therefore imports `mujoco`
only inside functions.
"""

from __future__ import annotations

import importlib
import os
import sys
import warnings
from importlib.resources import files
from pathlib import Path

from mujoco_impact.errors import ImpactWarning, PluginError

PLUGIN_NAME = "mujoco_impact.waveform"
"""Name under which the plugin is registered in MuJoCo."""

PLUGIN_PATH_VARIABLE = "MUJOCO_IMPACT_PLUGIN"
"""Environment variable that points to another build of the plugin library."""

_PROBE = f"""
<mujoco>
  <extension><plugin plugin="{PLUGIN_NAME}"/></extension>
</mujoco>
"""

_BUILD_HINT = "build it with `pip install .` in the root of the source tree"


def load() -> None:
    """Registers the plugin with MuJoCo; does nothing if it is registered.

    Raises:
        PluginError: If the library is missing, was built for another MuJoCo, or
            cannot be loaded.
    """
    if is_registered():
        return
    import mujoco

    path = plugin_path()
    if not os.environ.get(PLUGIN_PATH_VARIABLE):
        _check_version(mujoco.mj_versionString())
    try:
        mujoco.mj_loadPluginLibrary(str(path))
    except mujoco.FatalError as error:
        raise PluginError(f"cannot load the plugin library {path}: {error}") from error
    if not is_registered():
        msg = (
            f"{path} was loaded but did not register {PLUGIN_NAME!r} with MuJoCo "
            f"{mujoco.mj_versionString()}: it was linked to another copy of MuJoCo; "
            f"{_BUILD_HINT}"
        )
        raise PluginError(msg)


def load_or_warn() -> None:
    """Registers the plugin; a failure is a warning, so that `doctor` can explain it.

    For the import of the package. Whatever needs the plugin calls `load` again.
    """
    try:
        load()
    except PluginError as error:
        warnings.warn(str(error), ImpactWarning, stacklevel=3)


def is_registered() -> bool:
    """Returns whether MuJoCo of this process knows the plugin."""
    import mujoco

    try:
        mujoco.MjModel.from_xml_string(_PROBE)
    except ValueError as error:
        if "not found" in str(error):
            return False
        raise PluginError(f"unexpected answer to the probe model: {error}") from error
    return True


def plugin_path() -> Path:
    """Returns the path of the plugin library that `load` takes.

    It lies in the package directory, unless the environment variable
    `MUJOCO_IMPACT_PLUGIN` points elsewhere.

    Raises:
        PluginError: If no library is there.
    """
    override = os.environ.get(PLUGIN_PATH_VARIABLE)
    if override:
        path = Path(override)
        if not path.is_file():
            msg = f"{PLUGIN_PATH_VARIABLE}={override}: there is no such file"
            raise PluginError(msg)
        return path.resolve()
    # files(), not __file__: in an editable install the library lies elsewhere
    path = Path(str(files("mujoco_impact").joinpath(_library_name())))
    if not path.is_file():
        msg = f"the plugin library {path} does not exist: {_BUILD_HINT}"
        raise PluginError(msg)
    return path


def built_for() -> str | None:
    """Returns the MuJoCo version the library was built for, None if not built."""
    try:
        build = importlib.import_module("mujoco_impact._build")
    except ModuleNotFoundError:
        return None
    return str(build.MUJOCO_VERSION)


def _check_version(running: str) -> None:
    """Raises PluginError if the library was built for another MuJoCo."""
    built = built_for()
    if built is None or built == running:
        return
    msg = (
        f"mujoco-impact was built for MuJoCo {built}, but MuJoCo {running} is "
        f"installed, and MuJoCo has no stable binary interface: run "
        f"`pip install mujoco=={built}`, or rebuild mujoco-impact with "
        f"MuJoCo {running}"
    )
    raise PluginError(msg)


def _library_name() -> str:
    """Returns the file name of the library on this platform."""
    if sys.platform == "darwin":
        return "libmujoco_impact.dylib"
    if sys.platform == "win32":
        return "mujoco_impact.dll"
    return "libmujoco_impact.so"
