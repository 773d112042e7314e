"""Which state a run starts from.

One rule for every function and command: the keyframe that is asked for; else one called
"release"; else the only one that the model has; else the model's initial state.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import TypeAlias

import mujoco

from mujoco_impact.errors import SceneError
from mujoco_impact.text import closest

RELEASE = "release"
"""Keyframe that a run starts from if no other is asked for."""

INITIAL = "none"
"""What is asked for to start from the model's initial state."""

Keyframe: TypeAlias = str | int | None
"""Name or number of a keyframe, "none" for the initial state, None for the rule."""


def start_number(names: Sequence[str], keyframe: Keyframe) -> int | None:
    """Returns the number of the keyframe to start from, None for the initial state.

    Args:
        names: Names of the keyframes of a model, "" for one without.
        keyframe: What was asked for.

    Raises:
        SceneError: If there is no such keyframe.
    """
    if keyframe is None:
        if RELEASE in names:
            return names.index(RELEASE)
        return 0 if len(names) == 1 else None
    if isinstance(keyframe, str):
        if keyframe in names:
            return names.index(keyframe)
        if keyframe == INITIAL:
            return None
    else:
        number = operator.index(keyframe)
        if 0 <= number < len(names):
            return number
    shown = [name or str(number) for number, name in enumerate(names)]
    msg = f"there is no keyframe {keyframe!r}{closest(str(keyframe), shown)}"
    raise SceneError(msg)


def settled(
    names: Sequence[str], keyframe: Keyframe, *, given: bool = False
) -> Keyframe:
    """Returns the keyframe that the rule comes to: its number, or "none".

    Args:
        names: Names of the keyframes of a model.
        keyframe: What was asked for.
        given: Whether the start is given as a state, which then needs no keyframe.
    """
    if given and keyframe is None:
        return INITIAL
    number = start_number(names, keyframe)
    return INITIAL if number is None else number


def keyframe_names(model: mujoco.MjModel) -> list[str]:
    """Returns the names of the keyframes of a model, "" for one without."""
    return [model.key(number).name for number in range(model.nkey)]


def start_told(names: Sequence[str], number: Keyframe) -> str:
    """Returns in words what a run starts from: "keyframe 'release'"."""
    if not isinstance(number, int):
        return "the initial state"
    return f"keyframe {names[number]!r}" if names[number] else f"keyframe {number}"
