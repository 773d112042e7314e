"""A bank shot at pool: the table with a cue, and the task that is played on it.

The task knows neither dm_control nor gymnasium; `domain` and `gym` make environments.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco

import cradle_models
from mujoco_impact.envs.arithmetic import Number, hypotenuse, tolerance, where
from mujoco_impact.envs.cradle import TIMESTEP, Contacts, check_contacts, impulses
from mujoco_impact.envs.tasks import Bounds, Random, Source, Task
from mujoco_impact.scene import attach
from mujoco_impact.settings import Setting
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import compile_spec

DOMAIN = "billiards"
"""Name of the domain that the task belongs to."""

LENGTH, WIDTH = 1.98, 0.99
"""A table of 7 ft between the noses of its cushions, along x and y [m]."""

RADIUS = cradle_models.POOL.radius
"""Of the balls [m]."""

RESTITUTION = 0.9
"""Energetic restitution of all contacts, unless set otherwise."""

CUE_SPOT = (0.25, -0.3)
"""Where the cue ball lies at the start [m]."""

LOWEST_SPOT, HIGHEST_SPOT = (0.15, 0.0), (0.3, 0.15)
"""The object ball lies between these x and y at the start [m]."""

POCKET = (0.0, -WIDTH / 2)
"""The side pocket that it has to fall into, between two noses [m]."""

LARGEST_AIM = 0.5
"""The cue turns by up to this angle to either side of +y [rad]."""

FORCE = 10.0
"""Force of the stroke at an action of 1 [N]."""

BACK = 0.1
"""From the tip of the cue to the cue ball at the start [m]."""

TIP_RADIUS = 0.006

SHADES = {"self": (1.00, 0.80, 0.10), "effector": (0.80, 0.65, 0.45),
          "target": (0.10, 0.10, 0.10)}  # fmt: skip
"""Colours of the object ball, of the cue and of the ring around the pocket."""

HIGHLIGHT = (0.20, 0.75, 0.20)
"""Their colour at a reward of 1, if rewards are shown."""


def bank_model(*, contacts: Contacts = "impact", **settings: Setting) -> mujoco.MjModel:
    """Returns a pool table with a cue, a cue ball and an object ball.

    The balls, the bed and the cushions are named as by `cradle_models.billiards`. The
    body `stick` turns about the spot of the cue ball by the joint `aim` [rad], 0: along
    +y, positive: to the left, and slides along itself by the joint `stroke` [m], 0: the
    tip is 0.1 m behind the cue ball. The tip touches the cue ball and nothing else.

    Args:
        contacts: "impact" for those of this package, "mujoco" for MuJoCo's own.
        **settings: Settings of the impact law, see `mujoco_impact.attach`;
            restitution is 0.9 if it is absent.

    Raises:
        ConfigError: If an argument or a setting is not valid.
    """
    check_contacts(contacts, settings)
    spec = read_spec(cradle_models.billiards(1, length=LENGTH, timestep=TIMESTEP))
    # the start is that of an episode
    spec.delete(spec.keys[0])
    spec.body("cue").pos = (*CUE_SPOT, RADIUS)
    _add_stick(spec)
    _add_looks(spec)
    if contacts == "impact":
        options: dict[str, Any] = {"restitution": RESTITUTION, **settings}
        spec = attach(spec, **options)
    return compile_spec(spec)


def _add_stick(spec: mujoco.MjSpec) -> None:
    """Adds the cue: its joints, its tip and its motors."""
    half = math.sqrt(0.5)
    # turned so that its x axis is +y of the table
    stick = spec.worldbody.add_body(
        name="stick", pos=(*CUE_SPOT, RADIUS), quat=(half, 0.0, 0.0, half)
    )
    unit = math.degrees(1.0) if spec.compiler.degree else 1.0
    limited = mujoco.mjtLimited.mjLIMITED_TRUE
    turn = 1.2 * LARGEST_AIM * unit
    stick.add_joint(
        name="aim",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(0.0, 0.0, 1.0),
        limited=limited,
        range=(-turn, turn),
    )
    stick.add_joint(
        name="stroke",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=(1.0, 0.0, 0.0),
        limited=limited,
        # the follow-through ends two centimetres behind where it meets the ball
        range=(-BACK, BACK + 0.02),
        damping=0.5,
    )
    end = -(RADIUS + BACK + TIP_RADIUS)
    stick.add_geom(
        name="tip", size=(TIP_RADIUS, 0, 0), pos=(end, 0, 0), mass=0.3, contype=2,
        conaffinity=0, material="effector",
    )  # fmt: skip
    spec.geom("cue").conaffinity = 3
    stick.add_geom(
        name="shaft", type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=(TIP_RADIUS, 0, 0),
        fromto=(end, 0, 0, end - 0.7, 0, 0.1), mass=0.2, contype=0, conaffinity=0,
        material="effector",
    )  # fmt: skip
    aim = spec.add_actuator(name="aim", target="aim")
    stroke = spec.add_actuator(name="stroke", target="stroke")
    for motor in (aim, stroke):
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        motor.ctrllimited = limited
        motor.ctrlrange = (-1.0, 1.0)
    # a servo, critically damped for the 0.05 kg m² of the cue
    stiffness, damping = 20.0, 2.0
    aim.gainprm[0] = stiffness * LARGEST_AIM
    aim.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    aim.biasprm[1:3] = -stiffness, -damping
    stroke.gear[0] = FORCE


def _add_looks(spec: mujoco.MjSpec) -> None:
    """Adds a second camera and the materials that dm_control colours by the reward."""
    top = spec.worldbody.add_camera(name="top", pos=(0.0, 0.0, 2.2))
    top.alt.xyaxes = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    for name, shade in SHADES.items():
        colours = {"": shade, "_default": shade, "_highlight": HIGHLIGHT}
        for suffix, colour in colours.items():
            spec.add_material(name=name + suffix, rgba=(*colour, 1.0), specular=0.8)
    spec.geom("ball_1").material = "self"
    spec.worldbody.add_site(
        name="pocket",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=(0.05, 0.001, 0.0),
        pos=(POCKET[0], POCKET[1] - 0.05, -0.1),
        material="target",
    )


FAR = 0.5
"""Distance to the pocket that gives a tenth of the reward of passing over it [m]."""

NEAR_CUSHION = 0.03
"""A ball that came this near to touching the cushion, and now goes away, has touched it
[m]. It is looked at every 20 ms, and this cue makes no ball faster than 3 m/s."""

LARGEST = {"balls": 50.0, "velocities": 20.0, "stick": 50.0, "impulses": 10.0}
"""Bounds of the observations: no motion of the model exceeds them. [m], [m/s],
[rad], [m], [rad/s] and [m/s], [N s]"""


class BankShot(Task):
    """The object ball has to fall into the side pocket off the cushion opposite.

    The reward is 1 from then on. Before, it is up to 1/2 by how near the ball has come
    to the pocket since it turned round at that cushion, and 0 until it has.
    """

    memory = ("nearest", "was_at_cushion", "has_banked", "is_pocketed")

    def __init__(self, model: mujoco.MjModel) -> None:
        """Takes what stays the same from the model."""
        # name of the joint, and how many of its numbers are observed
        balls, stick = {"free_cue": 3, "free_ball_1": 3}, {"aim": 1, "stroke": 1}
        at = {name: int(model.joint(name).qposadr[0]) for name in (*balls, *stick)}
        moves = {name: int(model.joint(name).dofadr[0]) for name in at}
        self._ball, self._speed = at["free_ball_1"], moves["free_ball_1"]
        self._aim = at["aim"]
        self.sources = tuple(
            Source(field, slice(start[name], start[name] + size))
            for joints in (balls, stick)
            for field, start in (("qpos", at), ("qvel", moves))
            for name, size in joints.items()
        )
        self._impulses = impulses(model)
        if self._impulses is not None:
            self.sources += (Source("sensordata", self._impulses),)
        self._forget()

    def _forget(self) -> None:
        """Begins anew."""
        self.nearest: Number = LENGTH
        self.was_at_cushion: Number = False
        self.has_banked: Number = False
        self.is_pocketed: Number = False

    def begin(self, data: Any, random: Random) -> None:
        """Lays the object ball somewhere, and turns the cue a little."""
        self._forget()
        place = [
            float(random.uniform(low, high))
            for low, high in zip(LOWEST_SPOT, HIGHEST_SPOT, strict=True)
        ]
        data.qpos[self._ball : self._ball + 2] = place
        data.qpos[self._aim] = float(random.uniform(-0.1, 0.1))

    def follow(
        self,
        time: Number,  # noqa: ARG002
        qpos: Sequence[Number],
        qvel: Sequence[Number],
    ) -> None:
        """Follows the object ball."""
        x, y, z = qpos[self._ball : self._ball + 3]
        self.was_at_cushion |= y > WIDTH / 2 - RADIUS - NEAR_CUSHION
        self.has_banked |= self.was_at_cushion & (qvel[self._speed + 1] < 0.0)
        distance = hypotenuse(x - POCKET[0], y - POCKET[1])
        nearer = self.has_banked & (distance < self.nearest)
        self.nearest = where(nearer, distance, self.nearest)
        # it is below the bed, between the nose line and the wall of this pocket
        fell = (z < -RADIUS) & (y < POCKET[1])
        fell &= abs(x) < cradle_models.SIDE_MOUTH / 2
        self.is_pocketed |= self.has_banked & fell

    def in_mind(self) -> list[Number]:
        """Returns the smallest distance to the pocket since the bank [m]."""
        return [self.nearest]

    def bounds(self) -> dict[str, Bounds]:
        """Returns size and bounds of each observation, in their order."""
        sizes = {"balls": 6, "velocities": 6, "stick": 4}
        if self._impulses is not None:
            sizes["impulses"] = 3
        found = {
            name: Bounds(size, -LARGEST[name], LARGEST[name])
            for name, size in sizes.items()
        }
        return {**found, "nearest": Bounds(1, 0.0, LENGTH)}

    def reward(self) -> Number:
        """Returns 1 once the ball is in the pocket, up to 1/2 before."""
        near = 0.5 * tolerance(self.nearest, low=0.0, high=0.0, margin=FAR)
        return where(self.is_pocketed, 1.0, where(self.has_banked, near, 0.0))
