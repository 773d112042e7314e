"""Errors of the cradle on strings, which has no closed-form swing.

The truth is the same simulation without any contact, into which the velocities of the
Hertz impact are written at the instant of first contact: strings and integrator are
those of the run that is judged, and only the impact is charged to it.
"""

from __future__ import annotations

import copy

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.runner import initial_data
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import VELOCITY_DELAY, BenchScene
from mujoco_impact_lab.bench.simulate import START, MujocoSimulation
from mujoco_impact_lab.bench.truths import Errors, Truth, rms

_FREE = 6
"""Degrees of freedom of a free ball; the first one moves it along the row."""


def string_errors(
    scene: BenchScene, truth: Truth, simulation: MujocoSimulation, samples: Samples
) -> Errors:
    """Returns the error of the velocities after the first impact.

    Args:
        scene: The cradle on strings.
        truth: Velocities after its first impact.
        simulation: What was run.
        samples: Its motion; `angles` holds qpos and `velocities` qvel.
    """
    model = copy.copy(simulation.model)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    timestep = float(model.opt.timestep)
    data, wait = _before_contact(scene, model)
    read_at = data.time + VELOCITY_DELAY
    _partial_step(model, data, wait)
    speed = float(np.abs(data.qvel[::_FREE]).max())
    data.qvel[::_FREE] = speed * truth.velocities
    _partial_step(model, data, timestep - wait)
    sample = int(np.searchsorted(samples.time, read_at - timestep / 2))
    while data.time < samples.time[sample] - timestep / 2:
        mujoco.mj_step(model, data)
    difference = samples.velocities[sample, ::_FREE] - data.qvel[::_FREE]
    return Errors(rms(difference / speed))


def _before_contact(
    scene: BenchScene, model: mujoco.MjModel
) -> tuple[mujoco.MjData, float]:
    """Returns the state before the step of first contact, and how far into it [s]."""
    data = initial_data(model, keyframe=START)
    gap = _gap(model, data)
    while data.time < scene.duration:
        before, state = gap, copy.copy(data)
        mujoco.mj_step(model, data)
        gap = _gap(model, data)
        if gap <= 0:
            return state, float(model.opt.timestep) * before / (before - gap)
    msg = f"the balls of scene {scene.name} do not meet within {scene.duration} s"
    raise SceneError(msg)


def _gap(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Returns the gap between the ball that comes in and its neighbour [m]."""
    positions: Array = data.qpos.reshape(-1, 7)[:2, :3]
    # balls of a row have one size here
    diameter = 2.0 * float(model.geom("ball_1").size[0])
    return float(np.linalg.norm(positions[1] - positions[0])) - diameter


def _partial_step(model: mujoco.MjModel, data: mujoco.MjData, length: float) -> None:
    """Makes one step of another length [s]."""
    usual = float(model.opt.timestep)
    model.opt.timestep = length
    mujoco.mj_step(model, data)
    model.opt.timestep = usual
