"""A scene that takes a tenth of a second, and sweeps of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

TWO_BALLS = """
<mujoco model="two_balls">
  <option timestep="0.002" gravity="0 0 0"/>
  <default>
    <joint type="slide" axis="1 0 0"/>
    <geom mass=".1" size=".01" condim="1"/>
  </default>
  <worldbody>
    <body name="left" pos="-.02 0 0"><joint name="x1"/><geom name="left"/></body>
    <body name="right" pos=".0051 0 0"><joint name="x2"/><geom name="right"/></body>
  </worldbody>
  <keyframe><key name="shot" qvel="1 0"/></keyframe>
</mujoco>
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """Two balls on a rail; the left one comes in at 1 m/s."""
    file = tmp_path / "two_balls.xml"
    file.write_text(TWO_BALLS)
    return file


@pytest.fixture
def given(scene: Path) -> dict[str, Any]:
    """A sweep of two masses and two restitutions."""
    return {
        "scene": {"model": str(scene)},
        "duration": 0.04,
        "record": ["velocity_error", "velocity_after.right", "impulse"],
        "grid": {
            "mass": {"right": [0.1, 0.3]},
            "attach": {"restitution": [1.0, 0.5]},
        },
    }
