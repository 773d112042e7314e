"""Two free bodies of any shape that meet, and what is conserved when they do."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

import mujoco_impact

CORNERS = " ".join(
    f"{x} {y} {z}" for x in (-0.05, 0.05) for y in (-0.03, 0.03) for z in (-0.02, 0.02)
)

SHAPES = {
    "sphere": 'type="sphere" size=".04"',
    "capsule": 'type="capsule" size=".02 .08"',
    "cylinder": 'type="cylinder" size=".03 .06"',
    "ellipsoid": 'type="ellipsoid" size=".03 .03 .06"',
    "box": 'type="box" size=".05 .03 .02"',
    "mesh": 'type="mesh" mesh="block"',
}

INTEGRATORS = ("Euler", "implicit", "implicitfast", "RK4")

SYMMETRIC = {"sphere": (0, 1, 2), "capsule": (2,), "cylinder": (2,), "ellipsoid": (2,)}
"""Axes of the body about which a frictionless force cannot turn it."""


def pair(first: str, second: str, *, timestep: float = 2e-3, integrator: str = "Euler"):
    """Two free bodies without gravity, each with its centre of mass at its joint."""
    return f"""
    <mujoco>
      <option timestep="{timestep}" integrator="{integrator}" gravity="0 0 0"/>
      <asset><mesh name="block" vertex="{CORNERS}"/></asset>
      <worldbody>
        <body><freejoint/><geom name="a" {SHAPES[first]} density="3000"/></body>
        <body><freejoint/><geom name="b" {SHAPES[second]} density="2000"/></body>
      </worldbody>
    </mujoco>
    """


def unstruck(xml: str) -> mujoco.MjModel:
    """The same scene in which nothing touches anything."""
    return mujoco.MjModel.from_xml_string(
        xml.replace("<geom ", '<geom contype="0" conaffinity="0" ')
    )


@dataclasses.dataclass(frozen=True)
class Motion:
    """Sums over all bodies.

    Attributes:
        momentum: Linear, shape (3,) [kg m/s].
        kinetic: Kinetic energy [J].
        total: Kinetic and potential energy [J].
    """

    momentum: np.ndarray
    kinetic: float
    total: float


def motion(model: mujoco.MjModel, qpos: np.ndarray, qvel: np.ndarray) -> Motion:
    """What a state amounts to, by MuJoCo's own functions.

    The velocity of a semi-implicit integrator is behind its positions by half a step.
    For a body whose centre is not at its joint that matters: read with the pose of now,
    its momentum wobbles by m w^2 r h/2 as it turns, though its centre goes straight on.
    """
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    if model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4 and is_off_centre(model):
        half = 0.5 * model.opt.timestep
        mujoco.mj_forward(model, data)
        # what tumbles has another acceleration halfway there
        data.qvel[:] = qvel + half / 2 * data.qacc_smooth
        mujoco.mj_forward(model, data)
        data.qvel[:] = qvel + half * data.qacc_smooth
    for stage in (
        mujoco.mj_kinematics,
        mujoco.mj_comPos,
        mujoco.mj_comVel,
        mujoco.mj_makeM,
        mujoco.mj_energyPos,
        mujoco.mj_energyVel,
    ):
        stage(model, data)
    momentum = np.zeros(3)
    for body in range(1, model.nbody):
        velocity = np.zeros(6)
        kind = mujoco.mjtObj.mjOBJ_BODY
        mujoco.mj_objectVelocity(model, data, kind, body, velocity, 0)
        momentum += model.body_mass[body] * velocity[3:]
    return Motion(momentum, float(data.energy[1]), float(data.energy.sum()))


def is_off_centre(model: mujoco.MjModel) -> bool:
    """Whether the centre of mass of any body is not at its joint."""
    return bool(np.abs(model.body_ipos).max() > 1e-9)


def unit(rng: np.random.Generator, size: int) -> np.ndarray:
    """A random direction."""
    vector = rng.normal(size=size)
    return vector / np.linalg.norm(vector)


def throw(data: mujoco.MjData, seed: int, *, spin: float, off: float = 0.02) -> None:
    """Throws the second body at the first with 3 m/s; both turn with `spin` [rad/s]."""
    rng = np.random.default_rng(seed)
    direction = unit(rng, 3)
    data.qpos[3:7], data.qpos[10:14] = unit(rng, 4), unit(rng, 4)
    data.qpos[7:10] = 0.22 * direction + off * rng.normal(size=3)
    data.qvel[6:9] = -3.0 * direction
    data.qvel[3:6], data.qvel[9:12] = spin * unit(rng, 3), spin * unit(rng, 3)


def count(data: mujoco.MjData) -> int:
    """Impacts since reset."""
    return int(data.plugin_state[1])


@dataclasses.dataclass(frozen=True)
class Impact:
    """A step with an impact, and the same step without it."""

    before: Motion
    after: Motion
    without: Motion


def impacts_of(model: mujoco.MjModel, free: mujoco.MjModel, data, steps: int):
    """Runs and yields each step that has impacts."""
    flight = mujoco.MjData(free)
    for _ in range(steps):
        seen, qpos, qvel = count(data), data.qpos.copy(), data.qvel.copy()
        mujoco.mj_step(model, data)
        if count(data) == seen:
            continue
        flight.qpos[:], flight.qvel[:] = qpos, qvel
        mujoco.mj_step(free, flight)
        yield Impact(
            motion(free, qpos, qvel),
            motion(free, data.qpos, data.qvel),
            motion(free, flight.qpos, flight.qvel),
        )


def attached(xml: str, **settings) -> mujoco.MjModel:
    """The scene with its impacts ours, seen early enough for what turns fast."""
    settings.setdefault("gap", 0.015)
    return mujoco_impact.attach(xml, **settings, friction="none").compile()
