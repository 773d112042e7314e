"""One step of many worlds: MuJoCo Warp's, and the impacts in it."""

from __future__ import annotations

from typing import Any

import warp as wp
from mujoco_warp import step1, step2

from mujoco_impact.errors import SceneError
from mujoco_impact.warp.impacts import IMPACTS, Impacts
from mujoco_impact.warp.model import OURS
from mujoco_impact.warp.resolve import resolve
from mujoco_impact.warp.silence import silence

_ALIKE = (
    "qpos0",
    "body_mass",
    "body_pos",
    "body_quat",
    "body_ipos",
    "geom_pos",
    "geom_size",
    "geom_margin",
    "jnt_axis",
    "jnt_pos",
    "jnt_stiffness",
    "dof_armature",
    "dof_damping",
)
"""What of the model all worlds must share."""


def step(m: Any, d: Any, impacts: Impacts) -> None:
    """Advances all worlds by a timestep, impacts included.

    In place of `mujoco_warp.step`. It can be captured in a CUDA graph. Outside of one
    it raises what went wrong in a step before, as soon as the host has been told of
    it; see `Impacts.check`.

    Args:
        m: Model of `mujoco_impact.warp.put_model`.
        d: Its `mujoco_warp.Data`, of as many worlds as `impacts`.
        impacts: Of `put_impacts`, for the same model.

    Raises:
        SceneError: If the three do not belong together.
        SimulationError: If impacts went wrong, see `Impacts.check`.
    """
    _check(m, d, impacts)
    capturing = impacts.flags.device.is_capturing
    if not capturing:
        impacts.check_seen()
    step1(m, d)
    wp.copy(impacts.world.qpos, d.qpos)
    wp.copy(impacts.world.qvel, d.qvel)
    if d.naconmax > 0 and d.njmax > 0:
        wp.launch(
            silence,
            dim=d.naconmax,
            inputs=[
                impacts.bodies,
                d.qpos,
                d.qvel,
                m.opt.timestep,
                m.opt.gravity,
                impacts.weightless,
                impacts.pressing_gravity,
                d.nacon,
                d.contact.geom,
                d.contact.worldid,
                d.contact.dist,
                d.contact.includemargin,
                d.contact.frame,
                d.contact.efc_address,
                d.efc.D,
            ],
        )
    step2(m, d)
    wp.launch(
        resolve,
        dim=d.nworld,
        inputs=[
            impacts.bodies,
            impacts.pairs,
            impacts.paths,
            impacts.rows,
            impacts.world,
            m.opt.timestep,
            m.opt.gravity,
            impacts.weightless,
            impacts.pressing_gravity,
            impacts.implicit,
            impacts.law_steps,
            IMPACTS,
            d.qpos,
            d.qvel,
            d.sensordata,
            impacts.sensor,
            impacts.flags,
        ],
    )
    wp.copy(impacts.seen, impacts.flags)


def _check(m: Any, d: Any, impacts: Impacts) -> None:
    """Raises SceneError if model, data and impacts do not belong together."""
    if not getattr(m, OURS, False):
        msg = (
            "the model is not one of mujoco_impact.warp.put_model, which leaves "
            "impacts to mujoco_impact"
        )
        raise SceneError(msg)
    if (m.nq, m.nv) != impacts.size or d.nworld != impacts.nworld:
        msg = (
            f"impacts are of {impacts.nworld} worlds with nq, nv = {impacts.size}, but "
            f"the data is of {d.nworld} with {(m.nq, m.nv)}"
        )
        raise SceneError(msg)
    for name in _ALIKE:
        if getattr(m, name).shape[0] != 1:
            msg = f"mujoco_impact.warp does not support {name} that differs by world"
            raise SceneError(msg)
