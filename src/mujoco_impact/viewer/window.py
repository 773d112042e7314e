"""The window of the live view: MuJoCo's own viewer around a session."""

from __future__ import annotations

import math
import os
import queue
import sys
import threading
import time
import warnings
from typing import Any

import mujoco
import numpy as np

from mujoco_impact.errors import RenderingError
from mujoco_impact.video.arrows import COLOUR, LONGEST, arrows_of
from mujoco_impact.video.camera import framing
from mujoco_impact.video.motion import Panel
from mujoco_impact.viewer.session import KEYS, Session

ASPECT = 1.5
"""About the width of the window over its height."""

ROOM = 1.5
"""Room around the bodies at the start, for they will move."""

CLOSING_SECONDS = 5.0
"""Longest time that the window may take to close [s]."""

FRAME = 1 / 60
"""Time between two pictures [s]."""

LARGEST_LAG = 0.1
"""Time that a slow scene may lag behind before it is left out [s]."""


def show(session: Session, *, seconds: float | None = None) -> None:
    """Shows a session until its window is closed.

    Args:
        session: The session.
        seconds: Time after which the window closes by itself [s].

    Raises:
        RenderingError: If there is no display.
    """
    check_display()
    import mujoco.viewer as viewer

    others = set(threading.enumerate())
    pressed: queue.SimpleQueue[int] = queue.SimpleQueue()
    handle = viewer.launch_passive(
        session.model,
        session.data,
        key_callback=pressed.put,
        show_left_ui=False,
        show_right_ui=False,
    )
    drawing = set(threading.enumerate()) - others
    with handle:
        with handle.lock():
            _look(handle.cam, session)
        _loop(handle, session, pressed, seconds)
    # a process that ends while its window is drawn hangs, or dies of an X error
    for thread in drawing:
        thread.join(CLOSING_SECONDS)


def _loop(
    handle: Any,
    session: Session,
    pressed: queue.SimpleQueue[int],
    seconds: float | None,
) -> None:
    """Lets time pass and shows it, until the window is closed."""
    begin = last = time.perf_counter()
    while handle.is_running():
        now = time.perf_counter()
        if seconds is not None and now - begin > seconds:
            return
        with handle.lock():
            while not pressed.empty():
                session.press(pressed.get())
            session.skip(LARGEST_LAG * session.speed)
            session.advance(min(now - last, LARGEST_LAG))
            _draw_arrows(handle, session)
        handle.set_texts(_texts(session))
        handle.sync()
        last = now
        time.sleep(max(0.0, FRAME - (time.perf_counter() - now)))


def _look(camera: mujoco.MjvCamera, session: Session) -> None:
    """Turns the camera of the window, which the mouse moves, to what can move."""
    start = Panel("", np.zeros(1), session.data.qpos[None].copy())
    scratch = mujoco.MjData(session.model)
    seen = framing(session.model, scratch, start, ASPECT)
    camera.lookat[:] = seen.lookat
    camera.distance = ROOM * seen.distance


def _draw_arrows(handle: Any, session: Session) -> None:
    """Draws the impulses of the latest impacts into the window."""
    scene = handle.user_scn
    scene.ngeom = 0
    impacts = [impact for _, impact in session.recent]
    fovy = math.radians(float(session.model.vis.global_.fovy))
    reach = LONGEST * 2 * math.tan(fovy / 2) * handle.cam.distance
    for arrow in arrows_of(session.model, impacts, largest=session.largest):
        if scene.ngeom == scene.maxgeom:
            return
        shape = scene.geoms[scene.ngeom]
        colour = np.array([*COLOUR, 255], dtype=np.float32) / 255
        kind = mujoco.mjtGeom.mjGEOM_ARROW
        mujoco.mjv_initGeom(
            shape, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), colour
        )
        tip = arrow.point + reach * arrow.share
        mujoco.mjv_connector(shape, kind, reach / 20, arrow.point, tip)
        scene.ngeom += 1


def _texts(session: Session) -> list[tuple[Any, Any, str, str]]:
    """Returns what the window writes: the state above, the keys below."""
    grid = mujoco.mjtGridPos
    font = mujoco.mjtFontScale.mjFONTSCALE_150
    texts = []
    state = session.lines()
    keys = [(key.name, key.does) for key in KEYS]
    for place, lines in ((grid.mjGRID_TOPLEFT, state), (grid.mjGRID_BOTTOMLEFT, keys)):
        left, right = zip(*lines, strict=True)
        texts.append((font, place, "\n".join(left), "\n".join(right)))
    return texts


def check_display() -> None:
    """Raises RenderingError if no window can be opened."""
    if sys.platform == "darwin":
        _check_mjpython()
        return
    if sys.platform == "linux" and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        msg = "there is no display (DISPLAY is not set): make a video instead"
        raise RenderingError(f"{msg}, `mujoco-impact video MODEL`")
    import glfw

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        if glfw.init():
            # MuJoCo opens its window in another thread, where a failure hangs
            glfw.window_hint(glfw.VISIBLE, False)
            window = glfw.create_window(64, 64, "", None, None)
            glfw.default_window_hints()
            if window:
                glfw.destroy_window(window)
                return
    reason = str(said[0].message) if said else "GLFW does not say why"
    raise RenderingError(f"no window can be opened here: {reason}")


def _check_mjpython() -> None:
    """Raises RenderingError if a window needs MuJoCo's own Python."""
    import mujoco.viewer as viewer

    if viewer._MJPYTHON is None:
        msg = "on macOS windows need mjpython: `mjpython -m mujoco_impact view MODEL`"
        raise RenderingError(msg)
