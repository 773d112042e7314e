"""Balls that bounce, stack and share: spinning balls, a cannon, Bernoulli's problem.

Every model is at rest when loaded. Its keyframe ``release`` lets it go.
"""

import math
from collections.abc import Sequence

from cradle_models.ball import A, Ball
from cradle_models.checks import require_not_negative, require_positive, require_range
from cradle_models.errors import ModelValueError
from cradle_models.scene import (
    COLOURS,
    FLOOR,
    Integrator,
    camera,
    document,
    free_body,
    number,
    numbers,
    start,
)

#: A solid rubber ball.
RUBBER = Ball(mass=0.05, radius=0.022)

#: Large, middle and small: each has about a tenth of the mass of the one below.
CANNON = (Ball(0.6, 0.12), Ball(0.06, 0.056), Ball(0.006, 0.026))


def spinning_balls(
    spins: Sequence[float] = (-100.0, 0.0, 100.0),
    *,
    ball: Ball = RUBBER,
    height: float = 0.4,
    speed: float = 1.0,
    friction: float = 0.3,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str = "spinning_balls",
) -> str:
    """Return the MJCF of balls with spin that are thrown on a floor side by side.

    Friction turns spin into speed and back: with topspin a ball bounces forward, with
    backspin it stops or comes back. ``ball_1`` is the nearest. All fly along +x.

    Args:
        spins: Spin of each ball about +y in the keyframe ``release`` [rad/s], positive:
            topspin; ``speed / radius`` rolls.
        ball: The ball all of them are.
        height: Lowest point of the balls above the floor in the keyframe [m].
        speed: Speed along +x in the keyframe [m/s].
        friction: Coefficient of Coulomb friction between ball and floor.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    if not spins:
        raise ModelValueError("spins is empty; at least 1 is needed")
    require_positive("height [m]", height)
    require_not_negative("friction", friction)
    lane = 4 * ball.radius
    lanes = [(i - (len(spins) - 1) / 2) * lane for i in range(len(spins))]
    # they fly as long as they fall, rebound, and fall again
    reach = abs(speed) * 3 * math.sqrt(2 * height / max(gravity, 1e-3)) / 2
    world = [FLOOR]
    lifted, thrown = [], []
    for i, (y, spin) in enumerate(zip(lanes, spins, strict=True), start=1):
        world += free_body(
            f"ball_{i}", (0.0, y, ball.radius), _sphere(ball, (i - 1) % len(COLOURS))
        )
        lifted.append((-reach, y, ball.radius + height))
        thrown += [speed, 0.0, 0.0, 0.0, spin, 0.0]
    top = height + 2 * ball.radius
    return document(
        name,
        world=world,
        view=camera(1.5 * reach, top, -0.2 * top, lanes[-1], name="view"),
        materials=COLOURS,
        geom=f'<geom friction="{number(friction)}"/>',
        extent=max(reach, top),
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=start(lifted, thrown),
    )


def cannon(
    balls: Sequence[Ball] = CANNON,
    *,
    height: float = 0.4,
    gap: float = 0.0,
    friction: float = 0.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str = "cannon",
) -> str:
    """Return the MJCF of a Galilean cannon: a stack of balls that falls on a floor.

    The large ball at the bottom turns round first and meets the next, which still
    falls. Light balls above heavy ones fly off many times as high as they fell.

    Args:
        balls: The balls, from the lowest, ``ball_1``, to the highest.
        height: Lowest point above the floor in the keyframe ``release`` [m].
        gap: Gap between neighbours in the keyframe [m]; 0: they touch.
        friction: Coefficient of Coulomb friction; nothing slides as long as the balls
            are above each other.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    if not balls:
        raise ModelValueError("balls is empty; at least 1 ball is needed")
    require_not_negative("height [m]", height)
    require_not_negative("gap [m]", gap)
    require_not_negative("friction", friction)
    world = [FLOOR]
    lifted = []
    below = 0.0
    for i, ball in enumerate(balls):
        centre = below + ball.radius
        look = _sphere(ball, i % len(COLOURS))
        world += free_body(f"ball_{i + 1}", (0.0, 0.0, centre), look)
        lifted.append((0.0, 0.0, centre + height + i * gap))
        below += 2 * ball.radius
    # the top ball may fly much higher than this, which shows three of them well
    top = below + 4 * height
    return document(
        name,
        world=world,
        view=camera(top / 3, top, -0.05 * top, balls[0].radius, name="view"),
        materials=COLOURS,
        geom=f'<geom friction="{number(friction)}"/>',
        extent=top / 2,
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=start(lifted, [0.0] * (6 * len(balls))),
    )


def bernoulli(
    count: int = 2,
    *,
    ball: Ball = A,
    speed: float = 1.0,
    distance: float = 0.05,
    friction: float = 0.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    name: str | None = None,
) -> str:
    """Return the MJCF of Bernoulli's problem: one ball strikes several at once.

    ``ball_1`` flies along +x into the middle of `count` touching balls, ``ball_2`` and
    on, whose centres are the corners of a regular polygon across its way. It meets all
    of them at the same time. There is no gravity.

    Args:
        count: Number of balls that are struck, 2 to 5: more leave a hole that the
            striker fits through.
        ball: The ball all of them are.
        speed: Speed of the striker along +x in the keyframe ``release`` [m/s].
        distance: Way of the striker until it touches the others [m].
        friction: Coefficient of Coulomb friction between balls.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        name: Name of the model; None: ``bernoulli_`` and `count`.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    require_range("count", count, 2, 5)
    require_positive("speed [m/s]", speed)
    require_positive("distance [m]", distance)
    require_not_negative("friction", friction)
    radius = ball.radius
    ring = radius / math.sin(math.pi / count)
    # the striker touches: its centre is 2 r from theirs
    ahead = distance + math.sqrt(4 * radius**2 - ring**2)
    # two balls lie above each other, four like a window, seen from the side
    first = math.pi / 2 if count == 2 else math.pi / count
    angles = [first + 2 * math.pi * i / count for i in range(count)]
    places = [(0.0, 0.0, 0.0)]
    places += [(ahead, ring * math.cos(a), ring * math.sin(a)) for a in angles]
    world: list[str] = []
    for i, place in enumerate(places, start=1):
        world += free_body(f"ball_{i}", place, _sphere(ball, min(i - 1, 1)))
    across = ring + 4 * radius
    eye = numbers(1.3 * ahead, -3.2 * across, 1.3 * across)
    return document(
        name or f"bernoulli_{count}",
        world=world,
        view=f'<camera name="view" pos="{eye}" xyaxes="1 0 0 0 0.37 0.93"/>',
        materials=COLOURS,
        geom=f'<geom friction="{number(friction)}"/>',
        extent=ahead + across,
        timestep=timestep,
        integrator=integrator,
        gravity=0.0,
        after=start(places, [speed] + [0.0] * (6 * len(places) - 1)),
    )


def _sphere(ball: Ball, colour: int) -> str:
    """Return the attributes of the geom of a ball in one of the colours."""
    return (
        f'type="sphere" size="{number(ball.radius)}" mass="{number(ball.mass)}" '
        f'material="colour_{colour + 1}"'
    )
