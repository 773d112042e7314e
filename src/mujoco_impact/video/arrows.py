"""Arrows of impulses, drawn over the picture so that no body hides them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact.video.camera import Projection
from mujoco_impact.video.motion import Panel

if TYPE_CHECKING:
    from PIL import Image

LIFE = 0.3
"""How long an arrow is seen, in seconds of the video."""

LONGEST = 0.16
"""Length of the arrow of the largest impulse over the height of the picture."""

SHORTEST = 0.03
"""Impulses of less than this share of the largest have no arrow."""

COLOUR = (214, 39, 40)

_SMOOTHING = 2
"""Pixels drawn for one, each way."""


@dataclasses.dataclass(frozen=True, eq=False)
class Arrow:
    """An impulse on one body.

    Attributes:
        time: When it comes [s].
        point: Where [m], world frame, shape (3,).
        share: Direction times its share of the largest impulse, shape (3,).
    """

    time: float
    point: Array
    share: Array


def arrows_of(
    model: mujoco.MjModel, data: mujoco.MjData, panel: Panel
) -> list[Arrow]:
    """Returns the arrows of the impacts of a motion: one for each body that moves.

    Points of one pair of geoms that begin at the same time are one arrow.

    Args:
        model: The model that was run.
        data: Scratch data; mocap bodies stand where it has them.
        panel: The motion.
    """
    met: dict[tuple[float, tuple[str, str]], float] = {}
    for one in panel.impacts:
        key = one.time, one.geoms
        met[key] = met.get(key, 0.0) + one.impulse
    largest = max(met.values(), default=0.0)
    arrows = []
    for (time, geoms), impulse in met.items():
        if impulse < SHORTEST * largest or impulse <= 0:
            continue
        place = _contact(model, data, panel.at(model, time), geoms)
        if place is None:
            continue
        point, normal = place
        for geom, sign in zip(geoms, (-1.0, 1.0), strict=True):
            if model.body_weldid[model.geom_bodyid[_number(model, geom)]] != 0:
                share = sign * impulse / largest * normal
                arrows.append(Arrow(time, point, share))
    return arrows


def _contact(
    model: mujoco.MjModel, data: mujoco.MjData, qpos: Array, names: tuple[str, str]
) -> tuple[Array, Array] | None:
    """Returns point and normal of two geoms, from the first to the second."""
    data.qpos[:] = qpos
    mujoco.mj_fwdPosition(model, data)
    first, second = (_number(model, name) for name in names)
    geoms = np.asarray(data.contact.geom)
    forward = (geoms == (first, second)).all(axis=1)
    backward = (geoms == (second, first)).all(axis=1)
    mine = forward | backward
    if not mine.any():
        return None
    signs = np.where(forward, 1.0, -1.0)[mine][:, None]
    normals = signs * np.asarray(data.contact.frame)[mine, :3]
    point: Array = np.asarray(data.contact.pos)[mine].mean(axis=0)
    normal: Array = normals.mean(axis=0)
    return point, normal / (np.linalg.norm(normal) or 1.0)


def _number(model: mujoco.MjModel, name: str) -> int:
    """Returns the id of a geom as `Impact` calls it."""
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name)
    return number if number >= 0 else int(name.rpartition(" ")[2])


def draw(
    picture: Image.Image,
    arrows: Sequence[Arrow],
    projection: Projection,
    *,
    now: float,
    life: float,
) -> None:
    """Draws the arrows of the latest impacts into a picture; old ones fade.

    Args:
        picture: Picture in RGB.
        arrows: All arrows of the motion.
        projection: Where its points are in the picture.
        now: Time of the picture [s].
        life: How long an arrow is seen [s].
    """
    alive = [one for one in arrows if 0 <= now - one.time < life]
    if not alive:
        return
    from PIL import Image, ImageDraw

    size = (picture.width * _SMOOTHING, picture.height * _SMOOTHING)
    layer = Image.new("RGBA", size, (*COLOUR, 0))
    pen = ImageDraw.Draw(layer)
    for arrow in alive:
        age = (now - arrow.time) / life
        reach = LONGEST * projection.height_at(arrow.point)
        start = projection(arrow.point)
        end = projection(arrow.point + reach * arrow.share)
        if start is not None and end is not None:
            width = picture.height / 140 * _SMOOTHING
            colour = (*COLOUR, round(255 * (1 - age**2)))
            _draw_arrow(pen, start * _SMOOTHING, end * _SMOOTHING, width, colour)
    layer = layer.resize(picture.size, Image.Resampling.BOX)
    picture.paste(layer, mask=layer)


def _draw_arrow(
    pen: Any, start: Array, end: Array, width: float, colour: tuple[int, ...]
) -> None:
    """Draws one arrow; of a short one the head alone."""
    along = end - start
    length = float(np.linalg.norm(along))
    if not math.isfinite(length) or length < 1:
        return
    along /= length
    across = np.array([-along[1], along[0]])
    head = min(length, 4 * width)
    neck = end - head * along
    side = 0.45 * head * across
    half = 0.5 * width * across
    outline = [start - half, neck - half, neck - side, end]
    outline += [neck + side, neck + half, start + half]
    pen.polygon([tuple(corner) for corner in outline], fill=colour)
