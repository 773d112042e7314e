"""The impacts of the plugin beside MuJoCo Warp, for thousands of worlds on a GPU.

    m = mujoco_impact.warp.put_model(model)
    d = mujoco_warp.put_data(model, data, nworld=1000)
    impacts = mujoco_impact.warp.put_impacts(model, nworld=1000)
    mujoco_impact.warp.step(m, d, impacts)

Needs the extra `warp`.
"""

from __future__ import annotations

from mujoco_impact.extras import require

require("mujoco_warp")

from mujoco_impact.warp.impacts import Impacts, put_impacts  # noqa: E402
from mujoco_impact.warp.model import put_model  # noqa: E402
from mujoco_impact.warp.step import step  # noqa: E402

__all__ = ["Impacts", "put_impacts", "put_model", "step"]
