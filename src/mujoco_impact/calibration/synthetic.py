"""Synthetic shots: what two cameras would see of a row of steel balls.

The truth is the Hertz impact of `mujoco_impact.reference`; the balls swing as
pendulums before and after it. Each camera frame sees the centres with an error, and
velocities are estimated as they are from a film: a fit of the swing to the last frames
before, and the first frames after the impact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from mujoco_impact.calibration.shots import MOST_BALLS, Array, Shots
from mujoco_impact.errors import ShotsError
from mujoco_impact.reference import BallLike, first_impact

DEFAULT_SPEEDS = (0.3, 0.7)
"""Slowest and fastest impact [m/s]: drops of 5 to 25 mm."""

MOST_SHOTS = 10_000
"""Most shots that are made; a calibration has some ten."""

IMPACT_AXIS = 2
"""Frame of the paper: x vertical, y lateral, z along the row."""


@dataclass(frozen=True)
class Camera:
    """A pair of cameras and what is done with its film.

    Attributes:
        rate: Frames per second [1/s]; 500 in the paper.
        error: Standard deviation of each coordinate of a centre in a frame [m].
        frames: Frames used before, and as many after the impact.
        length: Length of the pendulums [m], known to the fit.
    """

    rate: float = 500.0
    error: float = 5e-5
    frames: int = 8
    length: float = 0.3

    def __post_init__(self) -> None:
        """Checks the values."""
        if not (self.rate > 0 and 0 <= self.error <= self.length < math.inf):
            msg = f"{self}: rate must be > 0, error 0 to the length of the pendulums"
            raise ShotsError(msg)
        if self.frames < 2:
            msg = f"frames = {self.frames}; allowed: 2 or more, to see a velocity"
            raise ShotsError(msg)


@dataclass(frozen=True)
class Truth:
    """What the shots are made from, and a calibration should find.

    Attributes:
        share: P_k / p of every contact, p the momentum that comes in [-].
        velocities: Velocities after the impact over the impact speed, shape (n,).
    """

    share: Array
    velocities: Array


def hertz_truth(balls: Sequence[BallLike], *, restitution: float = 1.0) -> Truth:
    """Returns the impact of a row by Hertz contacts, in units of what comes in.

    Args:
        balls: Balls with `mass` [kg] and `radius` [m], ball 1 coming in.
        restitution: Energetic restitution (bi-stiffness) of every contact.
    """
    return _hertz_truth(
        tuple(ball.mass for ball in balls),
        tuple(ball.radius for ball in balls),
        restitution,
    )


@cache
def _hertz_truth(
    masses: tuple[float, ...], radii: tuple[float, ...], restitution: float
) -> Truth:
    """Returns the impact of a row; integrated to 1e-12, so worth keeping."""
    impact = first_impact(
        masses,
        radii,
        restitution=restitution,
        dissipation=None if restitution == 1 else "bistiffness",
    )
    return Truth(impact.impulses / masses[0], impact.velocities)


def synthetic_shots(
    balls: Sequence[BallLike],
    *,
    count: int = 10,
    speeds: tuple[float, float] = DEFAULT_SPEEDS,
    restitution: float = 1.0,
    camera: Camera | None = None,
    velocity_noise: float = 0.0,
    seed: int = 0,
) -> Shots:
    """Returns shots of a row, filmed, or with velocities that are off by a given part.

    Args:
        balls: Balls with `mass` [kg] and `radius` [m], ball 1 coming in, the others at
            rest and touching; for example `cradle_models.balls("BAA")`.
        count: Number of shots, evenly spread over `speeds`.
        speeds: Slowest and fastest impact [m/s]. With a single speed S_w cannot be
            told from S_h.
        restitution: Energetic restitution (bi-stiffness) of every contact.
        camera: Film the shots; None: exact velocities and directions.
        velocity_noise: Standard deviation of an error of every component of every
            velocity, in parts of the impact speed of the shot.
        seed: Seed of all errors.

    Raises:
        ShotsError: If an argument is out of range.
    """
    low, high = speeds
    noisy = 0 <= velocity_noise < math.inf
    if not (1 <= count <= MOST_SHOTS and 0 < low <= high < math.inf and noisy):
        msg = (
            f"count = {count}, speeds = {speeds}, velocity_noise = {velocity_noise}; "
            f"needed: count 1 to {MOST_SHOTS}, 0 < slowest <= fastest [m/s], "
            "velocity_noise >= 0"
        )
        raise ShotsError(msg)
    if len(balls) > MOST_BALLS:
        raise ShotsError(f"{len(balls)} balls; allowed: 2 to {MOST_BALLS}")
    truth = hertz_truth(balls, restitution=restitution)
    speed = np.linspace(low, high, count)
    before = np.zeros((count, len(balls), 3))
    after = np.zeros_like(before)
    before[:, 0, IMPACT_AXIS] = speed
    after[:, :, IMPACT_AXIS] = speed[:, np.newaxis] * truth.velocities
    directions = np.zeros((count, len(balls) - 1, 3))
    directions[..., IMPACT_AXIS] = 1.0
    random = np.random.default_rng(seed)
    if camera is not None:
        before, after, directions = _filmed(balls, before, after, camera, random)
    scale = velocity_noise * speed[:, np.newaxis, np.newaxis]
    return Shots(
        np.array([ball.mass for ball in balls]),
        before + scale * random.standard_normal(before.shape),
        after + scale * random.standard_normal(after.shape),
        directions,
    )


def _filmed(
    balls: Sequence[BallLike],
    before: Array,
    after: Array,
    camera: Camera,
    random: np.random.Generator,
) -> tuple[Array, Array, Array]:
    """Returns velocities and directions as two cameras see them."""
    count = len(before)
    # the impact falls anywhere between two frames
    phase = random.uniform(0.0, 1.0, count)
    radii = np.array([ball.radius for ball in balls])
    centre = np.zeros((len(balls), 3))
    centre[1:, IMPACT_AXIS] = np.cumsum(radii[:-1] + radii[1:])
    seen_before, at_impact = _seen(-1, phase, before, centre, camera, random)
    seen_after, _ = _seen(+1, phase, after, centre, camera, random)
    line = np.diff(at_impact, axis=1)
    return seen_before, seen_after, line / np.linalg.norm(line, axis=2, keepdims=True)


def _seen(
    side: int,
    phase: Array,
    velocity: Array,
    centre: Array,
    camera: Camera,
    random: np.random.Generator,
) -> tuple[Array, Array]:
    """Returns velocities and positions at the impact, fitted to the frames of a side.

    Args:
        side: -1: the frames before the impact, +1: those after it.
        phase: Where between two frames the impact falls, shape (shots,).
        velocity: True velocities at the impact [m/s], shape (shots, balls, 3).
        centre: Centres at the impact [m], shape (balls, 3).
        camera: The cameras.
        random: Source of the errors.
    """
    frame = np.arange(camera.frames)
    # frames from the impact on: phase, phase + 1, ...; backwards: 1 - phase, ...
    offset = phase if side > 0 else 1 - phase
    time = side * (frame + offset[:, np.newaxis]) / camera.rate
    # x(t) = x(0) + v sin(ωt)/ω, ω² = g/L: the swing of a pendulum through its bottom
    omega = np.sqrt(9.81 / camera.length)
    swing = np.sin(omega * time) / omega
    seen = centre + swing[..., np.newaxis, np.newaxis] * velocity[:, np.newaxis]
    seen = seen + camera.error * random.standard_normal(seen.shape)
    mean = swing.mean(axis=1, keepdims=True)
    lever = swing - mean
    weight = (lever / (lever**2).sum(axis=1, keepdims=True))[
        ..., np.newaxis, np.newaxis
    ]
    fitted = (weight * seen).sum(axis=1)
    position = seen.mean(axis=1) - mean[..., np.newaxis] * fitted
    return fitted, position
