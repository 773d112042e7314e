"""One step of many worlds: MuJoCo Warp's, and the impacts in it."""

from __future__ import annotations

import dataclasses
from typing import Any

import mujoco_warp
import warp as wp
from mujoco_warp import step1, step2

from mujoco_impact.errors import SceneError
from mujoco_impact.warp.impacts import IMPACTS, Impacts
from mujoco_impact.warp.model import OURS
from mujoco_impact.warp.resolve import resolve
from mujoco_impact.warp.silence import silence

_LOOKS = ("cam_", "light_", "mat_", "geom_matid", "geom_rgba")

_SOLVER = (
    "body_invweight0",
    "dof_invweight0",
    "dof_solimp",
    "dof_solref",
    "geom_solimp",
    "geom_solmix",
    "geom_solref",
    "jnt_solimp",
    "jnt_solref",
)

_ALIKE = tuple(
    field.name
    for field in dataclasses.fields(mujoco_warp.Model)
    if getattr(field.type, "shape", ())[:1] == ("*",)
    and not field.name.startswith(_LOOKS)
    and field.name not in _SOLVER
)
"""What of the model all worlds must share: all but looks and MuJoCo's solver.

Tables of `Impacts` are of one world, and `support` has seen one. Options may differ:
the kernels read the timestep and gravity of each world.
"""


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
        _silence(m, d, impacts)
    step2(m, d)
    _resolve(m, d, impacts)
    wp.copy(impacts.seen, impacts.flags)


def _silence(m: Any, d: Any, impacts: Impacts) -> None:
    """Takes the contacts that move from the solver, between the halves of a step."""
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


def _resolve(m: Any, d: Any, impacts: Impacts) -> None:
    """Adds the impacts of the step, after it."""
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


def _check(m: Any, d: Any, impacts: Impacts) -> None:
    """Raises SceneError if model, data and impacts do not belong together."""
    if not getattr(m, OURS, False):
        msg = (
            "the model is not one of mujoco_impact.warp.put_model, which leaves "
            "impacts to mujoco_impact"
        )
        raise SceneError(msg)
    if getattr(m, OURS) != impacts.fingerprint:
        msg = (
            "the impacts are of another model, or of this before a change of it: put "
            "the model and the impacts anew, of one mujoco.MjModel"
        )
        raise SceneError(msg)
    ours = (impacts.nworld, impacts.world.qpos.shape[1], impacts.world.qvel.shape[1])
    theirs = (d.nworld, d.qpos.shape[1], d.qvel.shape[1])
    if theirs != ours:
        msg = (
            f"impacts are of {ours[0]} worlds with nq, nv = {ours[1:]}, but the data "
            f"is of {theirs[0]} with {theirs[1:]}"
        )
        raise SceneError(msg)
    for name in _ALIKE:
        if getattr(m, name).shape[0] != 1:
            msg = f"mujoco_impact.warp does not support {name} that differs by world"
            raise SceneError(msg)
