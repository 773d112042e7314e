"""Scripted policies: what little control the tasks need if impacts are right.

A policy takes the observations by name and returns the action. All of them give the
balls on the near side the energy they should come in with, and take away the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from mujoco_impact.trajectory import Array

LENGTH, RADIUS, GRAVITY = 0.3, 0.015, 9.81  # of the model [m], [m], [m/s²]
INERTIA = 1.0 + 0.4 * (RADIUS / LENGTH) ** 2  # of a pendulum over m L² [-]
LOSS = 1.25  # height to come in with over height to go out with, e = 0.95
GAIN = 200.0  # action per missing height [1/m]
SENT_HEIGHT = 0.015  # with which balls are sent out by `select` [m]


def swing_to(height: Array, observation: Mapping[str, Array]) -> Array:
    """Returns the actions that let ball i come in with a height of height[i] [m]."""
    angle, speed = (observation[name][: len(height)] for name in ("angles", "speeds"))
    # h = L (1 - cos θ) + I ω² / (2 m g)
    kinetic = INERTIA * (LENGTH * speed) ** 2 / (2 * GRAVITY)
    missing = height - LENGTH * (1 - np.cos(angle)) - kinetic
    # along the motion it adds energy, against it it takes some; from rest: outwards
    action = np.clip(GAIN * missing, -1, 1) * np.where(speed > 0, 1, -1)
    return np.where(angle < 0.01, action, 0.0)


def strike(observation: Mapping[str, Array]) -> Array:
    """Lets the first ball come in with the target height, plus what impacts lose."""
    return swing_to(LOSS * observation["target"], observation)


def damp(observation: Mapping[str, Array]) -> Array:
    """Takes all energy from the first ball, to which the others bring theirs."""
    return swing_to(np.zeros(1), observation)


def select(observation: Mapping[str, Array]) -> Array:
    """Lets as many balls come in together as are to go out; stops the others."""
    wanted = np.arange(3) < observation["wanted"]
    return swing_to(np.where(wanted, SENT_HEIGHT, 0.0), observation)


POLICIES: Mapping[str, Callable[[Mapping[str, Array]], Array]] = MappingProxyType(
    {"strike": strike, "damp": damp, "select": select}
)
"""Policy of each task by its name."""
