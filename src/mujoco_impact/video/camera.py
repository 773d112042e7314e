"""Where a scene is seen from, and where its points are in the picture."""

from __future__ import annotations

import itertools
import math

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.text import closest
from mujoco_impact.trajectory import Array
from mujoco_impact.video.motion import Panel

MOST_SAMPLES = 200
"""Samples of a motion that are looked at to frame it."""

SPARE = 1.15
"""Room around what moves."""


def camera_of(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    panel: Panel,
    wish: str | int | None,
    aspect: float,
) -> mujoco.MjvCamera:
    """Returns the camera that is asked for, or one that sees all that moves.

    Args:
        model: The model.
        data: Scratch data; mocap bodies stand where it has them.
        panel: The motion to be seen.
        aspect: Width over height of the picture.
        wish: Name or number of a camera of the model. None: its first camera that
            stands still, else one made for the motion.

    Raises:
        SceneError: If the model has no such camera.
    """
    number = _number(model, wish)
    if number is None:
        return framing(model, data, panel, aspect)
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
    camera.fixedcamid = number
    return camera


def _number(model: mujoco.MjModel, wish: str | int | None) -> int | None:
    """Returns the number of a camera of the model, None if one is to be made."""
    if wish is None:
        still = (model.cam_mode == mujoco.mjtCamLight.mjCAMLIGHT_FIXED) & (
            model.body_weldid[model.cam_bodyid] == 0
        )
        found = np.flatnonzero(still)
        return int(found[0]) if found.size else None
    names = [model.camera(index).name for index in range(model.ncam)]
    if isinstance(wish, str) and wish in names:
        return names.index(wish)
    if str(wish).isdecimal() and int(wish) < model.ncam:
        return int(wish)
    raise SceneError(f"there is no camera {wish!r}{closest(str(wish), names)}")


def framing(
    model: mujoco.MjModel, data: mujoco.MjData, panel: Panel, aspect: float
) -> mujoco.MjvCamera:
    """Returns a free camera that sees what moves, from where the model says."""
    camera = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, camera)
    moving = model.body_weldid[model.geom_bodyid] != 0
    geoms = np.flatnonzero(moving & (model.geom_rbound > 0))
    if not geoms.size:
        return camera
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    every = max(1, len(panel.time) // MOST_SAMPLES)
    reach = model.geom_rbound[geoms][:, None]
    # a pendulum hangs from the origin of its body
    bodies = np.flatnonzero(model.body_weldid != 0)
    for qpos in panel.qpos[::every]:
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        for corner in (data.geom_xpos[geoms] - reach, data.xpos[bodies]):
            low = np.minimum(low, corner.min(axis=0))
        for corner in (data.geom_xpos[geoms] + reach, data.xpos[bodies]):
            high = np.maximum(high, corner.max(axis=0))
    camera.lookat[:] = (low + high) / 2
    camera.distance = _distance(model, camera, (high - low) / 2, aspect)
    return camera


def _distance(
    model: mujoco.MjModel, camera: mujoco.MjvCamera, half: Array, aspect: float
) -> float:
    """Returns how far a camera must be to see a box that it looks at [m].

    Args:
        model: The model.
        camera: A free camera with its direction.
        half: Half of the sides of the box [m], shape (3,).
        aspect: Width over height of the picture.
    """
    turn, tilt = math.radians(camera.azimuth), math.radians(camera.elevation)
    right = np.array([math.sin(turn), -math.cos(turn), 0.0])
    forward = np.array([-right[1], right[0], math.tan(tilt)]) * math.cos(tilt)
    tangent = math.tan(math.radians(float(model.vis.global_.fovy)) / 2)
    corners = half * np.array(list(itertools.product((-1, 1), repeat=3)))
    across = np.abs(corners @ right) / (tangent * aspect)
    up = np.abs(corners @ np.cross(right, forward)) / tangent
    return SPARE * float((np.maximum(across, up) - corners @ forward).max())


class Projection:
    """Where points of the world are in a picture of a scene."""

    def __init__(self, scene: mujoco.MjvScene, width: int, height: int) -> None:
        """Reads the camera of a scene that was updated.

        Args:
            scene: The scene.
            width: Width of the picture [pixels].
            height: Height of the picture [pixels].
        """
        left, right = scene.camera
        self._size = np.array([width, height])
        self._position = (left.pos + right.pos) / 2.0
        self._forward = np.array(left.forward, dtype=np.float64)
        self._up = np.array(left.up, dtype=np.float64)
        self._orthographic = bool(left.orthographic)
        self._near = float(left.frustum_near)
        half_height = (left.frustum_top - left.frustum_bottom) / 2
        half_width = left.frustum_width or half_height * width / height
        self._half = np.array([half_width, half_height])
        self._centre = np.array(
            [
                (left.frustum_center + right.frustum_center) / 2,
                (left.frustum_top + left.frustum_bottom) / 2,
            ]
        )

    def __call__(self, point: Array) -> Array | None:
        """Returns the pixel (right, down) of a point; None if it is behind."""
        across, depth = self._in_camera(point)
        if depth <= self._near:
            return None
        if not self._orthographic:
            across = across * (self._near / depth)
        share = (across - self._centre) / self._half
        pixel: Array = (np.array([1.0, -1.0]) * share + 1.0) / 2.0 * self._size
        return pixel

    def height_at(self, point: Array) -> float:
        """Returns how much of the world the picture shows there, top to bottom [m]."""
        scale = 1.0 if self._orthographic else self._in_camera(point)[1] / self._near
        return float(2 * self._half[1] * scale)

    def _in_camera(self, point: Array) -> tuple[Array, float]:
        """Returns where a point is to the right and up, and how far ahead [m]."""
        offset = point - self._position
        right = np.cross(self._forward, self._up)
        across: Array = np.array([offset @ right, offset @ self._up])
        return across, float(offset @ self._forward)
