"""The MJCF scene of a case, and how to read the balls out of its states."""

from __future__ import annotations

import numpy as np

from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.case import Case
from mujoco_impact_lab.stress.layouts import Balls

GRAVITY = 9.81
"""Of scenes with pendulums [m/s^2]."""

SLEEP = 0.02
"""Speed below which balls may fall asleep, over that of the one that comes in."""

ARM = 20.0
"""Length of a pendulum over the radius of the largest ball."""


def mjcf(case: Case, balls: Balls) -> str:
    """Returns the scene as MJCF, with MuJoCo's own contacts."""
    gravity = GRAVITY if case.joint == "pendulum" else 0.0
    bodies = "\n".join(_body(case, balls, i) for i in range(len(balls.mass)))
    sleep = "sleep" in case.features
    flags = '<flag sleep="enable"/>' if sleep else ""
    tolerance = f'sleep_tolerance="{SLEEP * case.speed!r}"' if sleep else ""
    extension = '<extension><plugin plugin="mujoco.pid"/></extension>'
    return f"""
<mujoco model="case {case.seed}">
  {extension if "pid" in case.features else ""}
  <compiler angle="radian"/>
  <option timestep="{case.timestep!r}" gravity="0 0 {-gravity}"
          integrator="{case.integrator}" {tolerance}>{flags}</option>
  <worldbody>
{bodies}
  </worldbody>
{_elements(case, balls)}
</mujoco>"""


def initial_velocity(case: Case, balls: Balls) -> Array:
    """Returns qvel at the start, shape (nv,)."""
    if case.joint == "free":
        return np.hstack([balls.velocity, np.zeros_like(balls.velocity)]).ravel()
    if case.joint == "slides":
        return balls.velocity.ravel().copy()
    along: Array = balls.velocity[:, 0].copy()
    # a positive angle about −y lifts the ball towards +x
    return along / (ARM * case.radius) if case.joint == "pendulum" else along


def positions(case: Case, balls: Balls, qpos: Array) -> Array:
    """Returns the centres in each sample [m], shape (n_samples, n, 3)."""
    samples, n = len(qpos), len(balls.mass)
    if case.joint == "free":
        return qpos.reshape(samples, n, 7)[:, :, :3]
    if case.joint == "slides":
        return balls.position + qpos.reshape(samples, n, 3)
    centres = np.repeat(balls.position[None], samples, axis=0)
    if case.joint == "rail":
        centres[:, :, 0] += qpos
        return centres
    length = ARM * case.radius
    centres[:, :, 0] += length * np.sin(qpos)
    centres[:, :, 2] += length * (1 - np.cos(qpos))
    return centres


def velocities(case: Case, balls: Balls, qpos: Array, qvel: Array) -> Array:
    """Returns the velocities of the centres [m/s], shape (n_samples, n, 3)."""
    samples, n = len(qvel), len(balls.mass)
    if case.joint == "free":
        return qvel.reshape(samples, n, 6)[:, :, :3]
    if case.joint == "slides":
        return qvel.reshape(samples, n, 3)
    result = np.zeros((samples, n, 3))
    if case.joint == "rail":
        result[:, :, 0] = qvel
        return result
    length = ARM * case.radius
    result[:, :, 0] = length * np.cos(qpos) * qvel
    result[:, :, 2] = length * np.sin(qpos) * qvel
    return result


def _body(case: Case, balls: Balls, i: int) -> str:
    """Returns one ball with its joints."""
    where = " ".join(repr(float(x)) for x in balls.position[i])
    return (
        f'    <body name="body{i}" pos="{where}">{_joints(case, i)}'
        f'<geom name="ball{i}" type="sphere" size="{float(balls.radius[i])!r}" '
        f'mass="{float(balls.mass[i])!r}" condim="1"/></body>'
    )


def _joints(case: Case, i: int) -> str:
    """Returns the joints of one ball."""
    if case.joint == "free":
        return "<freejoint/>"
    extras = _joint_extras(case)
    if case.joint == "pendulum":
        arm = ARM * case.radius
        return (
            f'<joint name="joint{i}" type="hinge" axis="0 -1 0" pos="0 0 {arm!r}"'
            f"{extras}/>"
        )
    axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    if case.joint == "rail":
        axes = {"": "1 0 0"}
    return "".join(
        f'<joint name="joint{i}{name}" type="slide" axis="{axis}"{extras}/>'
        for name, axis in axes.items()
    )


def _joint_extras(case: Case) -> str:
    """Returns the attributes that the features give to every joint.

    Springs have a period of 200 steps, dampers a time constant of 500 steps: a scene
    that MuJoCo integrates well without contacts.
    """
    inertia = _inertia_scale(case)
    rate = 2 * np.pi / (200 * case.timestep)
    reach = 5 * case.radius / (ARM * case.radius if case.joint == "pendulum" else 1)
    text = ""
    if "spring" in case.features:
        text += f' stiffness="{inertia * rate**2!r}"'
    if "damping" in case.features:
        text += f' damping="{inertia / (500 * case.timestep)!r}"'
    if "armature" in case.features:
        text += f' armature="{inertia!r}"'
    if "limit" in case.features:
        text += f' limited="true" range="{-reach!r} {reach!r}"'
    return text


def _inertia_scale(case: Case) -> float:
    """Returns the smallest mass, or inertia of a pendulum, of the scene."""
    mass = case.density * 4 / 3 * np.pi * (case.radius / case.radius_ratio) ** 3
    mass = max(mass, 1e-12)
    return float(mass * (ARM * case.radius) ** 2 if case.joint == "pendulum" else mass)


def _elements(case: Case, balls: Balls) -> str:
    """Returns the elements that tie balls together or drive them."""
    last = len(balls.mass) - 1
    suffix = "x" if case.joint == "slides" else ""
    first_joint, last_joint = f"joint0{suffix}", f"joint{last}{suffix}"
    scale = _inertia_scale(case) / case.timestep * case.speed * 0.01
    if case.joint == "pendulum":
        scale /= ARM * case.radius
    text = ""
    if "equality" in case.features and last > 1:
        text += (
            f'<equality><joint joint1="{first_joint}" joint2="{last_joint}" '
            'polycoef="0 1 0 0 0"/></equality>'
        )
    if "tendon" in case.features:
        stiffness = _inertia_scale(case) / (50 * case.timestep) ** 2
        text += (
            f'<tendon><fixed name="cord" stiffness="{stiffness!r}">'
            f'<joint joint="{first_joint}" coef="1"/>'
            f'<joint joint="{last_joint}" coef="-1"/></fixed></tendon>'
        )
    actuators = ""
    if "motor" in case.features:
        actuators += f'<motor joint="{first_joint}" gear="{scale!r}"/>'
    if "pid" in case.features:
        actuators += (
            f'<plugin plugin="mujoco.pid" joint="{last_joint}" gear="{scale!r}">'
            '<config key="kp" value="1"/></plugin>'
        )
    return text + (f"<actuator>{actuators}</actuator>" if actuators else "")
