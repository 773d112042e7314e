"""The cradle of the environments: its model, and what the tasks see of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import mujoco
import numpy as np

import cradle_models
from mujoco_impact.envs.arithmetic import Number, cosine
from mujoco_impact.errors import ConfigError
from mujoco_impact.scene import attach
from mujoco_impact.sensor import IMPULSE, NUMBERS_PER_GEOM, sensor_slice
from mujoco_impact.settings import Setting
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.trajectory import Array

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
    check_contacts(contacts, settings)
    spec = read_spec(cradle_models.row(pattern, timestep=TIMESTEP))
    _add_motors(spec, motors)
    _add_looks(spec, count, motors)
    if contacts == "impact":
        options: dict[str, Any] = {"restitution": RESTITUTION, **settings}
        spec = attach(spec, **options)
    return compile_spec(spec)


def check_contacts(contacts: Contacts, settings: Mapping[str, Setting]) -> None:
    """Raises ConfigError for other contacts, or settings of what is not there."""
    if contacts not in ("impact", "mujoco"):
        msg = f"contacts = {contacts!r}: allowed are 'impact' and 'mujoco'"
        raise ConfigError(msg)
    if contacts == "mujoco" and settings:
        msg = f"contacts='mujoco' takes no settings, got {', '.join(settings)}"
        raise ConfigError(msg)


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


def impulses(model: mujoco.MjModel) -> slice | None:
    """Returns where the sensor has the impulse of the last impact of each geom.

    None if the model has no plugin, and so no sensor.
    """
    if model.nsensor == 0:
        return None
    numbers = sensor_slice(model)
    return slice(numbers.start + IMPULSE, numbers.stop, NUMBERS_PER_GEOM)


class CradleState:
    """What does not change of a row of pendulums of `cradle_model`.

    Attributes:
        size: Number of balls, n.
        impulses: Where the impulse of the last impact of each ball [N s] is among the
            sensors; None if the model has no plugin.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        """Reads the model."""
        self.size = int(model.njnt)
        self._length: list[float] = np.linalg.norm(model.body_ipos[1:], axis=1).tolist()
        gravity = float(-model.opt.gravity[2])
        # I / (2 m g): height that an angular velocity is worth [m s²]
        swing = model.dof_M0 / (2.0 * model.body_mass[1:] * gravity)
        self._swing: list[float] = swing.tolist()
        self.impulses = impulses(model)

    def heights(
        self, angles: Sequence[Number], speeds: Sequence[Number]
    ) -> list[Number]:
        """Returns how high each ball would swing if nothing met it [m].

        Above its lowest point, from the energy of the pendulum:
        h = L (1 - cos θ) + I ω² / (2 m g).

        Args:
            angles: θ of each ball [rad].
            speeds: ω of each ball [rad/s].
        """
        return [
            length * (1.0 - cosine(angle)) + swing * speed * speed
            for length, swing, angle, speed in zip(
                self._length, self._swing, angles, speeds, strict=True
            )
        ]

    def place(self, data: Any, angles: Array) -> None:
        """Puts the balls at rest at these angles [rad], shape (n,): 0 is hanging."""
        data.qpos[:] = angles
        data.qvel[:] = 0.0
