"""The model of the cradle environments: a row of pendulums with motors."""

from __future__ import annotations

import math
from typing import Any, Literal

import mujoco

import cradle_models
from mujoco_impact.errors import ConfigError
from mujoco_impact.scene import attach
from mujoco_impact.settings import Setting
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import compile_spec

Contacts = Literal["impact", "mujoco"]
"""Whose contacts the balls have: this package's, or MuJoCo's own."""

TIMESTEP = 0.002
"""Timestep of the physics [s]."""

RESTITUTION = 0.95
"""Energetic restitution of the balls, unless set otherwise."""

MOTOR_TORQUE = 0.25
"""Torque of a motor at an action of 1 [N m]: holds ball A of 0.3 m at 47 degrees."""

LARGEST_ANGLE = 1.6
"""Where the hinges stop [rad]."""

SHADES = {"self": (0.66, 0.68, 0.72), "effector": (0.36, 0.40, 0.46),
          "target": (0.62, 0.54, 0.40)}  # fmt: skip
"""Colours of the other balls, of those with a motor, and of the last one."""

HIGHLIGHT = (0.95, 0.75, 0.20)
"""Their colour at a reward of 1, if rewards are shown."""


def cradle_model(
    pattern: str = "AAAAA",
    *,
    motors: int = 1,
    contacts: Contacts = "impact",
    **settings: Setting,
) -> mujoco.MjModel:
    """Returns a row of touching balls on hinges, the first of which have motors.

    Joints, bodies and geoms are named as by `cradle_models.row`; the motor at
    `hinge_1` is called `motor_1`. Angles are 0 at the bottom and positive towards the
    last ball.

    Args:
        pattern: Letters A and B of `cradle_models`, from left to right.
        motors: How many balls, from the left, have a motor.
        contacts: "impact" for those of this package, "mujoco" for MuJoCo's own.
        **settings: Settings of the impact law, see `mujoco_impact.attach`;
            restitution is 0.95 if it is absent.

    Raises:
        ConfigError: If an argument or a setting is not valid.
    """
    count = len(pattern)
    if not 1 <= motors <= count:
        raise ConfigError(f"motors = {motors}: allowed are 1 to {count}")
    if contacts not in ("impact", "mujoco"):
        msg = f"contacts = {contacts!r}: allowed are 'impact' and 'mujoco'"
        raise ConfigError(msg)
    if contacts == "mujoco" and settings:
        msg = f"contacts='mujoco' takes no settings, got {', '.join(settings)}"
        raise ConfigError(msg)
    spec = read_spec(cradle_models.row(pattern, timestep=TIMESTEP))
    _add_motors(spec, motors)
    _add_looks(spec, count, motors)
    if contacts == "impact":
        options: dict[str, Any] = {"restitution": RESTITUTION, **settings}
        spec = attach(spec, **options)
    return compile_spec(spec)


def _add_motors(spec: mujoco.MjSpec, motors: int) -> None:
    """Adds the motors, and the stops of all hinges."""
    # the compiler takes the angles of a specification in its own unit
    stop = math.degrees(LARGEST_ANGLE) if spec.compiler.degree else LARGEST_ANGLE
    for joint in spec.joints:
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.range = (-stop, stop)
    for number in range(1, motors + 1):
        motor = spec.add_actuator(name=f"motor_{number}", target=f"hinge_{number}")
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        motor.gear[0] = MOTOR_TORQUE
        motor.ctrllimited = mujoco.mjtLimited.mjLIMITED_TRUE
        motor.ctrlrange = (-1.0, 1.0)


def _add_looks(spec: mujoco.MjSpec, count: int, motors: int) -> None:
    """Adds a second camera and the materials that dm_control colours by the reward."""
    side = spec.worldbody.add_camera(name="side", pos=(0.5, -0.5, 0.05))
    side.alt.xyaxes = (1.0, 1.0, 0.0, -0.2, 0.2, 1.0)
    for name, shade in SHADES.items():
        colours = {"": shade, "_default": shade, "_highlight": HIGHLIGHT}
        for suffix, colour in colours.items():
            spec.add_material(
                name=name + suffix,
                rgba=(*colour, 1.0),
                specular=0.9,
                shininess=0.9,
                reflectance=0.2,
            )
    roles = ["effector"] * motors + ["self"] * (count - motors)
    roles[-1] = "target"
    for number, role in enumerate(roles, start=1):
        spec.geom(f"ball_{number}").material = role
