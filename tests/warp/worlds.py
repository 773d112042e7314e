"""Running the same scene in MuJoCo with the plugin and in MuJoCo Warp beside ours."""

import mujoco
import mujoco_warp
import numpy as np

from mujoco_impact import warp

# two balls above a table, and one that lies on it; no friction
TABLE = """<mujoco>
  <option timestep=".002"/>
  <default><geom size=".05" condim="1"/></default>
  <worldbody>
    <geom name="table" type="plane" size="1 1 .1"/>
    <body name="a" pos="0 0 .2"><freejoint/><geom name="a"/></body>
    <body name="b" pos=".01 0 .4"><freejoint/><geom name="b" size=".04"/></body>
    <body name="c" pos=".5 0 .05"><freejoint/><geom name="c"/></body>
  </worldbody>
</mujoco>"""


class Worlds:
    """Worlds of one model beside MuJoCo's simulation of the first of them."""

    def __init__(self, model, *, qpos=None, qvel=None, **options):
        """Starts them at rows of qpos and qvel, or at the keyframe 0 of the model."""
        data = mujoco.MjData(model)
        if qpos is None and qvel is None:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        rows = {
            name: np.atleast_2d(getattr(data, name) if given is None else given)
            for name, given in (("qpos", qpos), ("qvel", qvel))
        }
        nworld = max(len(values) for values in rows.values())
        for name, values in rows.items():
            rows[name] = np.broadcast_to(values, (nworld, values.shape[1]))
            getattr(data, name)[:] = rows[name][0]
        mujoco.mj_forward(model, data)
        self.model, self.data = model, data
        self.m = warp.put_model(model)
        # room for contacts that the first pose does not have
        self.d = mujoco_warp.put_data(model, data, nworld=nworld, nconmax=16, njmax=32)
        self.d.qpos.assign(rows["qpos"].astype(np.float32))
        self.d.qvel.assign(rows["qvel"].astype(np.float32))
        self.impacts = warp.put_impacts(model, nworld=nworld, **options)

    def step(self, steps=1):
        """Steps all worlds on Warp."""
        for _ in range(steps):
            warp.step(self.m, self.d, self.impacts)
        self.impacts.check()

    def step_both(self, steps=1):
        """Steps them and MuJoCo; returns the largest difference of a position."""
        largest = 0.0
        for _ in range(steps):
            mujoco.mj_step(self.model, self.data)
            self.step()
            difference = np.abs(self.qpos[0] - self.data.qpos).max()
            largest = max(largest, float(difference))
        return largest

    @property
    def qpos(self):
        return self.d.qpos.numpy()

    @property
    def qvel(self):
        return self.d.qvel.numpy()
