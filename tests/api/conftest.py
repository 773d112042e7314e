"""Scenes that were not written for this package."""

from __future__ import annotations

import pytest

MIXED = """
<mujoco model="mixed">
  <option timestep="0.001"/>
  <default>
    <default class="padded"><geom margin="0.004" gap="0.002"/></default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <geom class="padded" name="ledge" type="box" size=".2 .2 .05" pos="1 0 .05"/>
    <body name="post" pos="-1 0 .2">
      <geom name="post" type="box" size=".1 .1 .2"/>
    </body>
    <body name="marble" pos="0 0 .5">
      <freejoint/>
      <geom size=".02"/>
      <geom name="paint" size=".021" contype="0" conaffinity="0" mass="0"/>
    </body>
    <body name="cart" pos="1 0 .5">
      <freejoint/>
      <geom type="box" size=".1 .05 .03"/>
      <geom class="padded" name="bumper" type="capsule" size=".01 .05"/>
      <body name="flag" pos="0 0 .1"><geom type="cylinder" size=".015 .04"/></body>
    </body>
  </worldbody>
  <contact><pair geom1="bumper" geom2="ledge" margin=".01"/></contact>
</mujoco>
"""

TWO_BALLS = """
<mujoco model="two_balls">
  <option timestep="0.002" gravity="0 0 0"/>
  <default>
    <joint type="slide" axis="1 0 0"/>
    <geom mass=".1" size=".01"/>
  </default>
  <worldbody>
    <body pos="-.02 0 0"><joint name="x1"/><geom name="left"/></body>
    <body pos=".0051 0 0"><joint name="x2"/><geom name="right"/></body>
  </worldbody>
  <keyframe><key name="shot" qvel="1 0"/></keyframe>
</mujoco>
"""


@pytest.fixture
def mixed() -> str:
    """A plane, fixed boxes, free bodies, an unnamed geom, a class and a pair."""
    return MIXED


@pytest.fixture
def two_balls() -> str:
    """Two equal balls on a rail; in the keyframe "shot" the left one comes in."""
    return TWO_BALLS
