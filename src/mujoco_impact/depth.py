"""How far bodies may overlap before MuJoCo's own contact carries them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from mujoco_impact.errors import ConfigError
from mujoco_impact.ownership import fall_speed, round_up, smallest_size

DEPTH = 1e-7
"""Default depth where pulses come at once [m]: too little to see in how bodies rest."""

ROUNDING = 1e-6
"""The same where bodies overlap by rounding [m]: the sixth digit of a length in metres,
in which files tell where bodies are that are to touch."""

SOFT = 1e9
"""Young's modulus [Pa] below which contacts often outlast a timestep. What they leave
overlapped meanwhile MuJoCo would push apart: at 4 MPa that cost 1e-5 of the energy."""

SMALLEST_OF_LONG, LARGEST = 0.01, 0.5
"""Bounds of the default depth of longer pulses over half-width: the largest is
half-way to the centre."""

PAPER_DURATION = 10e-3
"""Duration of a pulse [s] that the default depth allows for if duration="paper"."""


def default_depth(
    model: mujoco.MjModel, owned: Sequence[str], config: Mapping[str, str]
) -> float:
    """Returns the overlap at which MuJoCo's own contact takes over, M [m].

    During a pulse of duration W bodies that close with the speed u overlap by up to
    u W / 2, half of what two geoms of this depth leave; u is taken as that of a fall
    through the scene.

    Args:
        model: The scene, compiled with the owned geoms of any valid margin.
        owned: Names of the owned geoms.
        config: Attributes of the plugin.
    """
    duration = _pulse_duration(config)
    if duration == 0:
        soft = _softest(config) < SOFT
        return ROUNDING if soft or _overlaps_by_rounding(model, owned) else DEPTH
    size = smallest_size(model, owned)
    overlap = fall_speed(model) * duration / 2
    return round_up(min(max(overlap, SMALLEST_OF_LONG * size), LARGEST * size))


def check_depth(model: mujoco.MjModel, owned: Sequence[str], depth: float) -> None:
    """Raises ConfigError if bodies could pass through each other above a depth.

    Two owned geoms overlap by twice the depth before MuJoCo carries them. If that is
    their width, their centres meet, and the normal of their contact turns around.
    """
    largest = smallest_size(model, owned)
    if depth >= largest:
        msg = (
            f"depth = {depth}: must be less than {largest:.4g} m, half of the width of "
            "the smallest owned geom, or bodies pass through each other"
        )
        raise ConfigError(msg)


def _overlaps_by_rounding(model: mujoco.MjModel, owned: Sequence[str]) -> bool:
    """Returns whether an owned geom overlaps another by rounding in the initial pose.

    MuJoCo would push such bodies apart. If they hang in a row, that is as far as an
    impact presses them, and it would be another impact.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    ours = [model.geom(name).id for name in owned]
    overlap = -data.contact.dist[np.isin(data.contact.geom, ours).any(axis=1)]
    # each of the two is rounded
    return bool(np.any((overlap > DEPTH) & (overlap < 2 * ROUNDING)))


def _softest(config: Mapping[str, str]) -> float:
    """Returns the smallest Young's modulus of the settings and the materials [Pa]."""
    usual = [config.get("young", "2e11")]
    of_materials = re.findall(r"young=(\S+)", config.get("materials", ""))
    return min(float(number.rstrip(";")) for number in usual + of_materials)


def _pulse_duration(config: Mapping[str, str]) -> float:
    """Returns how long pulses last [s]; 0 for a Hertz contact, which is shorter."""
    usual = "paper" if config.get("law") == "calibrated" else "hertz"
    duration = config.get("duration", usual)
    if duration in ("hertz", "paper"):
        return 0.0 if duration == "hertz" else PAPER_DURATION
    return float(duration)
