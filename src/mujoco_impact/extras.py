"""Optional libraries, and how to get them from where this package came."""

from __future__ import annotations

import importlib
import importlib.util
from functools import cache
from importlib import metadata
from typing import Any

from mujoco_impact.errors import MissingExtraError


def install_hint(extra: str) -> str:
    """Returns the command that brings an extra.

    The package is on no index yet: an extra comes from the folder it came from. Its
    name has hyphens there: pip 23.0 does not find `dm_control`.
    """
    return f'`pip install "{_place()}[{extra.replace("_", "-")}]"`'


def require_matplotlib() -> None:
    """Raises MissingExtraError if matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        msg = f"pictures need matplotlib: run {install_hint('plot')}"
        raise MissingExtraError(msg)


def _place() -> str:
    """Returns the folder that the package was installed from, "." if unknown."""
    import json
    from urllib.parse import unquote, urlparse

    try:
        text = metadata.distribution("mujoco-impact").read_text("direct_url.json")
    except metadata.PackageNotFoundError:
        return "."
    url = urlparse(json.loads(text)["url"]) if text else None
    return unquote(url.path) if url and url.scheme == "file" else "."


_EXTRA = {
    "distributed": "cluster",
    "dm_control": "dm_control",
    "gymnasium": "gymnasium",
    "mujoco_warp": "warp",
    "pyarrow": "cluster",
    "warp": "warp",
}


def is_installed(library: str) -> bool:
    """Returns whether a library could be imported, without importing it."""
    return importlib.util.find_spec(library) is not None


def require(module: str) -> Any:
    """Imports a module of an optional library.

    Args:
        module: Its full name, such as "dm_control.rl.control".

    Raises:
        MissingExtraError: If the library is not installed, or does not work with
            the MuJoCo of this process.
    """
    library = module.partition(".")[0]
    if not is_installed(library):
        msg = f"{library} is not installed: run {install_hint(_EXTRA[library])}"
        raise MissingExtraError(msg)
    if library == "dm_control":
        _check_dm_control()
    return importlib.import_module(module)


@cache
def _check_dm_control() -> None:
    """Raises MissingExtraError if dm_control was built for another MuJoCo.

    dm_control lists the fields of MuJoCo's structures when it is built, and every
    model fails with an AttributeError if one of them is gone.
    """
    import mujoco

    sizes = importlib.import_module("dm_control.mujoco.wrapper.mjbindings.sizes")
    gone = [
        field
        for field in sizes.array_sizes["mjmodel"]
        if not hasattr(mujoco.MjModel, field)
    ]
    if gone:
        msg = (
            f"the installed dm_control was built for another MuJoCo than "
            f"{mujoco.mj_versionString()} (it expects MjModel.{gone[0]}): install it "
            "with `pip install --no-binary dm_control dm_control`"
        )
        raise MissingExtraError(msg)
