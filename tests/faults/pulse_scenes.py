"""A simulation in the middle of a pulse: where faults hurt most."""

from __future__ import annotations

import mujoco
import numpy as np

import mujoco_impact

PULSE = 5e-3  # [s]: five steps

ROW = """
<mujoco model="row">
  <option timestep="0.001" gravity="0 0 0"{option}/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
  <worldbody>
    {decoration}
    <body pos="-.0203 0 0"><joint name="x1"/><geom name="one"/></body>
    <body><joint name="x2"/><geom name="two"/></body>
    <body pos=".02 0 0"><joint name="x3"/><geom name="three"/></body>
  </worldbody>
  <actuator><motor joint="x2"/></actuator>
</mujoco>
"""


def row(*, decoration: str = "", option: str = "", **settings) -> mujoco.MjSpec:
    """Two touching balls and one that comes in at 0.1 m/s, owned by the plugin."""
    settings.setdefault("duration", PULSE)
    xml = ROW.format(decoration=decoration, option=option)
    return mujoco_impact.attach(xml, geoms=["one", "two", "three"], **settings)


def active(data: mujoco.MjData) -> int:
    """Pulses under way."""
    return int(data.plugin_state[6])


def in_mid_pulse(model: mujoco.MjModel) -> mujoco.MjData:
    """The simulation two steps after the first pulse began."""
    data = mujoco.MjData(model)
    data.qvel[0] = 0.1
    for _ in range(100):
        mujoco.mj_step(model, data)
        if active(data):
            mujoco.mj_step(model, data)
            assert active(data)
            return data
    raise AssertionError("no pulse began")


def momentum(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Of all balls along x [kg m/s]."""
    return float(model.body_mass[1:] @ data.qvel)


def finite(data: mujoco.MjData) -> bool:
    return all(
        np.isfinite(array).all() for array in (data.qpos, data.qvel, data.plugin_state)
    )
