"""Videos of motions, side by side, without a display (needs the extra `video`).

`Trajectory.render` and `mujoco-impact video` end here.
"""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import math
import os
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.runner import Model, initial_data
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.starts import Keyframe, keyframe_names, settled
from mujoco_impact.video import arrows, encode, page
from mujoco_impact.video.camera import Projection, camera_of
from mujoco_impact.video.motion import Panel, place
from mujoco_impact.video.opengl import backend_name, drawing_context

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["Panel", "View", "check_rendering", "dressed", "frames", "write_video"]

MOST_FRAMES = 20_000
"""Most pictures of a video; more is a slip of the speed."""

MOST_GEOMS = 10_000
"""Most geoms that are drawn, decorations included."""

LARGEST_SIDE = 4096
"""Largest width or height of a panel [pixels]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class View:
    """How motions are shown.

    Attributes:
        speed: Simulated seconds in a second of video; below 1 is slow motion.
        camera: Name or number of a camera of the model. None: its first one that
            stands still, else one that sees all that moves in the first panel.
        size: Width and height of one panel [pixels].
        fps: Pictures per second of video. A GIF shows 25 or 50 as exactly.
        arrows: Whether impulses are drawn as arrows.
    """

    speed: float = 1.0
    camera: str | int | None = None
    size: tuple[int, int] = (640, 480)
    fps: int = 25
    arrows: bool = True

    def __post_init__(self) -> None:
        """Raises ConfigError if a number is out of range."""
        if not (math.isfinite(self.speed) and self.speed > 0):
            msg = f"speed = {self.speed}: must be a finite number > 0"
            raise ConfigError(msg)
        if not all(16 <= side <= LARGEST_SIDE for side in self.size):
            msg = f"size = {self.size}: width and height must be 16 to {LARGEST_SIDE}"
            raise ConfigError(msg)
        if not 1 <= self.fps <= 120:
            raise ConfigError(f"fps = {self.fps}: must be 1 to 120")

    def times(self, duration: float) -> list[float]:
        """Returns the simulated time of each picture of a motion [s]."""
        count = int(duration / self.speed * self.fps + 1e-9) + 1
        if count > MOST_FRAMES:
            msg = (
                f"speed = {self.speed:g}: {duration:g} s at {self.fps} pictures a "
                f"second make {count} pictures, allowed: {MOST_FRAMES}"
            )
            raise ConfigError(msg)
        return [picture * self.speed / self.fps for picture in range(count)]


def check_rendering(path: str | os.PathLike[str], at: float | None = None) -> None:
    """Raises an error if a video of that name cannot be made here.

    Args:
        path: File that is to be written.
        at: Time of a .png [s], if it was asked for.

    Raises:
        RenderingError: If nothing renders here.
        MissingExtraError: If a library is missing.
        ConfigError: If the ending is not known, or not that of one picture.
    """
    ending = encode.check_target(path)
    if at is not None and ending != ".png":
        msg = f"at = {at}: only a .png is of one time, not {os.fspath(path)!r}"
        raise ConfigError(msg)
    backend_name()


def write_video(
    model: Model,
    panels: Sequence[Panel],
    path: str | os.PathLike[str],
    *,
    view: View | None = None,
    keyframe: Keyframe = None,
    at: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Writes a video of motions of one scene, side by side.

    Args:
        model: The model that was run. A scene that is not compiled yet gets a sky if
            it has none, where MuJoCo shows black.
        panels: The motions.
        path: File to write: .mp4, .gif, .webp, or .png for one picture.
        view: Speed, camera, size and so on.
        keyframe: What the runs started from, see `run`; mocap bodies stand where it
            has them.
        at: Time of a .png [s]; by default that of the first impact, or the end.
        progress: Called now and then with the finished fraction, 0 to 1.

    Returns:
        The path written.

    Raises:
        RenderingError: If nothing renders here.
        MissingExtraError: If a library is missing.
        ConfigError: If the view, the ending of the path or the time is not valid.
        SceneError: If the model or the camera is not valid.
    """
    check_rendering(path, at)
    view = view or View()
    begin = min(float(panel.time[0]) for panel in panels)
    end = max(float(panel.time[-1]) for panel in panels)
    if at is not None and not begin <= at <= end:
        msg = f"at = {at}: must be a time of the motion, {begin:g} to {end:g} s"
        raise ConfigError(msg)
    times: Sequence[float] = [begin + time for time in view.times(end - begin)]
    if Path(path).suffix.lower() == ".png":
        times = [_telling_time(panels) if at is None else at]
    times = encode.with_previews(times, path)
    pictures = frames(model, panels, times, view=view, keyframe=keyframe)
    with contextlib.closing(pictures):
        return encode.write(_told(pictures, len(times), progress), path, fps=view.fps)


def frames(
    model: Model,
    panels: Sequence[Panel],
    times: Sequence[float],
    *,
    view: View,
    keyframe: Keyframe = None,
) -> Generator[Image.Image, None, None]:
    """Yields the picture of each time, with captions; see `write_video`."""
    compiled = _drawn(model)
    start = settled(keyframe_names(compiled), keyframe)
    data = initial_data(compiled, keyframe=start)
    for panel in panels:
        if panel.qpos.shape[1] != compiled.nq:
            msg = (
                f"the motion has {panel.qpos.shape[1]} positions, the model "
                f"{compiled.nq}: give the model that was run"
            )
            raise SceneError(msg)
    shown = [
        arrows.arrows_of(compiled, panel.impacts) if view.arrows else []
        for panel in panels
    ]
    captions = [(panel.caption, "mujoco-impact" in panel.caption) for panel in panels]
    aspect = view.size[0] / view.size[1]
    camera = camera_of(compiled, data, panels[0], view.camera, aspect)
    speed = page.speed_text(view.speed)
    with drawing_context(compiled, *view.size) as context:
        canvas = _Canvas(compiled, camera, context, view)
        for time in times:
            pictures = [
                canvas.picture(data, panel, marks, time)
                for panel, marks in zip(panels, shown, strict=True)
            ]
            yield page.side_by_side(pictures, captions, (f"t = {time:.3f} s", speed))


class _Canvas:
    """Draws one scene from one camera."""

    def __init__(
        self,
        model: mujoco.MjModel,
        camera: mujoco.MjvCamera,
        context: mujoco.MjrContext,
        view: View,
    ) -> None:
        self._model = model
        self._camera = camera
        self._view = view
        self._scene = mujoco.MjvScene(model, MOST_GEOMS)
        self._option = mujoco.MjvOption()
        self._context = context
        width, height = view.size
        self._frame = mujoco.MjrRect(0, 0, width, height)
        self._pixels = np.zeros((height, width, 3), dtype=np.uint8)

    def picture(
        self, data: mujoco.MjData, panel: Panel, marks: list[arrows.Arrow], time: float
    ) -> Image.Image:
        """Returns the picture of a motion at a time."""
        from PIL import Image

        place(self._model, data, panel.at(self._model, time))
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(
            self._model, data, self._option, None, self._camera, everything, self._scene
        )
        mujoco.mjr_render(self._frame, self._scene, self._context)
        mujoco.mjr_readPixels(self._pixels, None, self._frame, self._context)
        # OpenGL counts rows from below
        picture = Image.fromarray(self._pixels[::-1].copy())
        projection = Projection(self._scene, *self._view.size)
        life = arrows.LIFE * self._view.speed
        arrows.draw(picture, marks, projection, now=time, life=life)
        return picture


def _drawn(model: Model) -> mujoco.MjModel:
    """Returns a model of its own to be drawn, dressed if it is not compiled yet."""
    if isinstance(model, mujoco.MjModel):
        return copy.copy(model)
    return compile_spec(dressed(read_spec(model)))


def dressed(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Gives a scene a sky and a light if it has none, and returns it.

    MuJoCo shows a scene without a sky in black, and one without a light in the dark.
    """
    skybox = mujoco.mjtTexture.mjTEXTURE_SKYBOX
    if not any(texture.type == skybox for texture in spec.textures):
        spec.add_texture(
            name="mujoco_impact_sky",
            type=skybox,
            builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
            rgb1=[0.93, 0.95, 0.97],
            rgb2=[0.70, 0.74, 0.80],
            width=32,
            height=192,
        )
    if not spec.lights:
        sun = spec.worldbody.add_light(name="mujoco_impact_sun")
        sun.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        sun.dir = [0.3, 0.4, -1.0]
    return spec


def _telling_time(panels: Sequence[Panel]) -> float:
    """Returns the time of the first impact of any motion, or the end [s]."""
    met = [one.time for panel in panels for one in panel.impacts]
    return min(met, default=float(panels[0].time[-1]))


def _told(
    pictures: Iterator[Image.Image],
    count: int,
    progress: Callable[[float], None] | None,
) -> Iterator[Image.Image]:
    """Yields the pictures and tells how many are done."""
    for number, picture in enumerate(pictures):
        yield picture
        if progress is not None:
            progress((number + 1) / count)
