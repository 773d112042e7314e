"""An OpenGL context without a window: EGL, else OSMesa.

PyOpenGL is bound to one of them when it is first imported, and a broken driver may end
the process; so which one works is tried in a process of its own.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any

import mujoco

from mujoco_impact.errors import RenderingError

HEADLESS = ("egl", "osmesa")
"""Ways to render without a display on Linux, the best first."""

OFF = ("disable", "disabled", "off", "false", "0")
"""Values of MUJOCO_GL that forbid rendering."""

TRIAL_SECONDS = 60

_TRIAL = """
import mujoco
from mujoco.{backend} import GLContext
context = GLContext(64, 64)
context.make_current()
mujoco.MjrContext(mujoco.MjModel.from_xml_string("<mujoco/>"), 150)
context.free()
"""


@contextlib.contextmanager
def drawing_context(
    model: mujoco.MjModel, width: int, height: int
) -> Iterator[mujoco.MjrContext]:
    """Makes an OpenGL context current; yields MuJoCo's resources of a model in it.

    Args:
        model: The model; its offscreen buffer becomes large enough.
        width: Width of the pictures [pixels].
        height: Height of the pictures [pixels].

    Raises:
        RenderingError: If this machine has no way to render.
    """
    backend = backend_name()
    context: Any = None
    try:
        module = importlib.import_module(f"mujoco.{backend}")
        context = module.GLContext(width, height)
        context.make_current()
        resources = _resources(model, width, height)
    except Exception as error:  # whatever a driver's binding raises
        if context is not None:
            context.free()
        msg = f"cannot render with {backend} ({_reason(error)})"
        raise RenderingError(msg) from error
    try:
        yield resources
    finally:
        resources.free()
        context.free()


def backend_name() -> str:
    """Returns the module of `mujoco` that makes contexts here, such as "egl".

    The variable MUJOCO_GL decides if it is set; else what works without a display.

    Raises:
        RenderingError: If none does, or MUJOCO_GL forbids it.
    """
    wish = os.environ.get("MUJOCO_GL", "").strip().lower()
    if wish in OFF:
        msg = f"cannot render: MUJOCO_GL={wish} switches rendering off; unset it"
        raise RenderingError(msg)
    if wish in ("egl", "osmesa", "glfw", "cgl"):
        return wish
    if sys.platform != "linux":
        return "cgl" if sys.platform == "darwin" else "glfw"
    return _headless(os.environ.get("PYOPENGL_PLATFORM", "").strip().lower())


@cache
def _headless(platform: str) -> str:
    """Returns the first of `HEADLESS` that works.

    Args:
        platform: What PyOpenGL is bound to already, else empty.
    """
    reasons = []
    for backend in HEADLESS:
        if platform not in ("", backend):
            reasons.append(f"{backend}: PYOPENGL_PLATFORM is {platform}")
            continue
        reason = _failure(backend)
        if not reason:
            return backend
        reasons.append(f"{backend}: {reason}")
    msg = (
        f"cannot render, for neither EGL nor OSMesa works here ({'; '.join(reasons)}): "
        "install one (Debian: apt install libegl1 libgl1-mesa-dri, or libosmesa6)"
    )
    raise RenderingError(msg)


def _failure(backend: str) -> str:
    """Returns why a way to render does not work, empty if it does."""
    environment = {**os.environ, "MUJOCO_GL": "disable", "PYOPENGL_PLATFORM": ""}
    try:
        trial = subprocess.run(
            [sys.executable, "-c", _TRIAL.format(backend=backend)],
            env=environment,
            capture_output=True,
            text=True,
            timeout=TRIAL_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return _reason(error)
    if trial.returncode == 0:
        return ""
    lines = trial.stderr.strip().splitlines()
    return lines[-1] if lines else f"it ended with code {trial.returncode}"


def _reason(error: Exception) -> str:
    """Returns an error on one line."""
    return " ".join(str(error).split()) or type(error).__name__


def _resources(model: mujoco.MjModel, width: int, height: int) -> mujoco.MjrContext:
    """Returns MuJoCo's resources of a model for pictures of that size."""
    model.vis.global_.offwidth = max(width, model.vis.global_.offwidth)
    model.vis.global_.offheight = max(height, model.vis.global_.offheight)
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
    return context
