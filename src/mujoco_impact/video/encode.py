"""Writing pictures one after another into a file: MP4, GIF, WebP, or one PNG."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mujoco_impact.errors import ConfigError, MissingExtraError
from mujoco_impact.extras import install_hint
from mujoco_impact.files import replacing

if TYPE_CHECKING:
    from PIL import Image

ENDINGS = (".mp4", ".gif", ".webp")
"""Moving pictures that can be written; ".png" is a still."""

PREVIEWS = 8
"""Frames of all of a GIF that its colours are taken from."""

COLOURS = 128
"""Colours of a GIF."""

QUALITY = 70
"""Quality of a WebP, 0 to 100."""


def check_target(path: str | os.PathLike[str]) -> str:
    """Returns the ending of a file; errors if it cannot be made here.

    Raises:
        ConfigError: If the ending is not known.
        MissingExtraError: If a library is missing.
    """
    ending = Path(path).suffix.lower()
    if ending not in (*ENDINGS, ".png"):
        msg = f"cannot write a video to {os.fspath(path)!r}: it must end in "
        raise ConfigError(msg + ", ".join(ENDINGS) + " (or .png for a still)")
    try:
        import PIL  # noqa: F401

        if ending == ".mp4":
            import imageio_ffmpeg  # noqa: F401
    except ImportError as error:
        msg = f"videos need {error.name}: run {install_hint('video')}"
        raise MissingExtraError(msg) from error
    return ending


def with_previews(
    times: Sequence[float], path: str | os.PathLike[str]
) -> Sequence[float]:
    """Returns the times of all pictures that `write` takes for a file.

    A GIF needs to know its colours first: `PREVIEWS` pictures come before its own.
    """
    if Path(path).suffix.lower() != ".gif":
        return times
    chosen = np.linspace(0, len(times) - 1, PREVIEWS).round().astype(int)
    return [*(times[index] for index in chosen), *times]


def write(
    frames: Iterable[Image.Image], path: str | os.PathLike[str], *, fps: int
) -> Path:
    """Writes pictures of one size into a file.

    Args:
        frames: Pictures in RGB, at least one; see `with_previews`.
        path: File to write; its ending says what kind.
        fps: Pictures per second of video.
    """
    ending = check_target(path)
    target = Path(path)
    with replacing(target) as part:
        if ending == ".mp4":
            _write_mp4(frames, part, fps)
        elif ending == ".png":
            next(iter(frames)).save(part)
        else:
            _write_animation(frames, part, fps)
    return target


def _write_mp4(frames: Iterable[Image.Image], path: Path, fps: int) -> None:
    """Writes H.264, which every browser plays."""
    import imageio.v2 as imageio

    # yuv420p halves the colours: both sides must be even
    writer: Any = imageio.get_writer(
        path, fps=fps, codec="libx264", quality=8, macro_block_size=2
    )
    with writer:
        for frame in frames:
            writer.append_data(np.asarray(frame))


def _write_animation(frames: Iterable[Image.Image], path: Path, fps: int) -> None:
    """Writes a GIF or a WebP that goes round for ever."""
    options: dict[str, Any] = {"duration": round(1000 / fps), "loop": 0}
    frames = iter(frames)
    if path.suffix.lower() == ".gif":
        frames = _few_colours(frames)
        options |= {"optimize": False, "disposal": 1}
    else:
        options |= {"quality": QUALITY, "method": 4}
    first = next(frames)
    first.save(path, save_all=True, append_images=frames, **options)


def _few_colours(frames: Iterator[Image.Image]) -> Iterator[Image.Image]:
    """Yields the frames after the previews, in one palette of their colours."""
    from PIL import Image

    known = [np.asarray(frame) for frame in itertools.islice(frames, PREVIEWS)]
    strip = Image.fromarray(np.concatenate(known))
    palette = strip.quantize(COLOURS, method=Image.Quantize.MEDIANCUT)
    for frame in frames:
        yield frame.quantize(palette=palette, dither=Image.Dither.NONE)
