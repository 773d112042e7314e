"""Arrows of impulses, drawn over the picture so that no body hides them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from mujoco_impact.impact import Impact
from mujoco_impact.trajectory import Array
from mujoco_impact.video.camera import Projection

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
    model: mujoco.MjModel, impacts: Iterable[Impact], *, largest: float = 0.0
) -> list[Arrow]:
    """Returns the arrows of impacts: one for each body that moves.

    Points of one pair of geoms that begin at the same time are one arrow.

    Args:
        model: The model that was run.
        impacts: Its impacts.
        largest: An impulse that has the longest arrow, if none of them is larger [N s].
    """
    groups: dict[tuple[float, tuple[str, str]], list[Impact]] = {}
    for impact in impacts:
        groups.setdefault((impact.time, impact.geoms), []).append(impact)
    impulses = {
        key: np.sum([_impulse(one) for one in group], axis=0)
        for key, group in groups.items()
    }
    sizes = [float(np.linalg.norm(one)) for one in impulses.values()]
    largest = max([largest, *sizes])
    arrows = []
    for (time, geoms), impulse in impulses.items():
        if not np.linalg.norm(impulse) > SHORTEST * largest:
            continue
        point = np.mean([one.position for one in groups[time, geoms]], axis=0)
        for geom, sign in zip(geoms, (-1.0, 1.0), strict=True):
            if model.body_weldid[model.geom_bodyid[_number(model, geom)]] != 0:
                arrows.append(Arrow(time, point, sign * impulse / largest))
    return arrows


def _impulse(impact: Impact) -> Array:
    """Returns the whole impulse on the second geom [N s], shape (3,)."""
    normal = impact.impulse * np.array(impact.normal)
    impulse: Array = normal + np.array(impact.tangential_impulse)
    return impulse


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
