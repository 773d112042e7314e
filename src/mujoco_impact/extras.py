"""Optional libraries, and how to get them from where this package came."""

from __future__ import annotations

import importlib.util
from importlib import metadata

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
