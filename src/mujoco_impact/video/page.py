"""Putting pictures side by side, with captions above and the time below."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any

from mujoco_impact.text import printable

if TYPE_CHECKING:
    from PIL import Image

PAPER, INK, QUIET = (255, 255, 255), (33, 37, 41), (108, 117, 125)

OURS_INK = (196, 30, 58)
"""Colour of the captions of our own motions."""

BETWEEN = 4
"""White between two pictures [pixels]."""


def side_by_side(
    pictures: Sequence[Image.Image],
    captions: Sequence[tuple[str, bool]],
    footer: tuple[str, str],
) -> Image.Image:
    """Returns one picture of several of the same size.

    Args:
        pictures: The pictures, from left to right.
        captions: Text above each, and whether it is ours.
        footer: Text at the lower left and right.
    """
    from PIL import Image, ImageDraw

    width, height = pictures[0].size
    letter = max(11, height // 20)
    footing = 2 * letter
    band = footing if any(caption for caption, _ in captions) else 0
    whole = len(pictures) * (width + BETWEEN) - BETWEEN
    page = Image.new("RGB", (_even(whole), _even(band + height + footing)), PAPER)
    pen = ImageDraw.Draw(page)
    for index, (picture, (caption, ours)) in enumerate(
        zip(pictures, captions, strict=True)
    ):
        left = index * (width + BETWEEN)
        page.paste(picture, (left, band))
        _write(pen, (left + width / 2, band / 2), caption, letter, width, "mm",
               OURS_INK if ours else INK)  # fmt: skip
    middle = band + height + footing / 2
    _write(pen, (letter, middle), footer[0], letter * 0.85, whole, "lm", QUIET)
    right = whole - letter
    _write(pen, (right, middle), footer[1], letter * 0.85, whole, "rm", QUIET)
    return page


def speed_text(speed: float) -> str:
    """Returns how fast a video is against time, in words."""
    if speed == 1:
        return "real time"
    share = Fraction(speed).limit_denominator(1000)
    if share.numerator == 1 and share.denominator > 1:
        return f"slowed down {share.denominator} times"
    return f"{speed:g} x real time"


def _write(
    pen: Any,
    place: tuple[float, float],
    text: str,
    size: float,
    room: float,
    anchor: str,
    colour: tuple[int, int, int],
) -> None:
    """Writes a line, in smaller letters if it has no room."""
    text = printable(text)
    font = _font(round(size))
    length = pen.textlength(text, font=font)
    if length > 0.96 * room:
        font = _font(max(6, int(size * 0.96 * room / length)))
    pen.text(place, text, fill=colour, font=font, anchor=anchor)


@cache
def _font(size: int) -> Any:
    """Returns the letters that come with Pillow."""
    from PIL import ImageFont

    return ImageFont.load_default(size)


def _even(number: int) -> int:
    """Returns a number, or the even one above it: videos need even sides."""
    return number + number % 2
