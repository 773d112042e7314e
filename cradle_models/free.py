"""Free balls: the cradle on strings, and loose balls of which two collide."""

import math
from collections.abc import Sequence

from cradle_models.ball import Ball, balls, centres, gaps
from cradle_models.checks import require_positive, require_range
from cradle_models.scene import (
    Integrator,
    camera,
    document,
    free_body,
    kinds,
    number,
    numbers,
)


def two_string(
    pattern: str | Sequence[Ball],
    *,
    length: float = 0.3,
    spread: float = 0.1,
    release: float = 30.0,
    released: int = 1,
    gap: float | Sequence[float] = 0.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str | None = None,
) -> str:
    """Return the MJCF of a cradle as sold: free balls, each on two strings in a V.

    The strings are spatial tendons with an upper limit of length: they pull and never
    push. Both end in one eye at the top of the ball. Their limit is as stiff as MuJoCo
    allows at the timestep (time constant of two steps), so they stretch a little.

    Args:
        pattern: Letters A and B, or the balls, left to right.
        length: Height of the beams above the centres of the hanging balls [m].
        spread: Distance of each beam from the plane of the balls [m].
        release: Angle by which the released balls are lifted [deg], 0 to 80.
        released: Number of balls lifted at the left end.
        gap: Gap between neighbours at rest [m], one for all or one for each pair.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model; None: ``two_string_`` and the number of balls.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    chain = balls(pattern)
    largest = max(ball.radius for ball in chain)
    require_positive("spread [m]", spread)
    require_positive("length [m] minus the largest radius", length - largest)
    require_range("release [deg]", release, 0.0, 80.0)
    require_range("released", released, 0, len(chain))
    positions = centres(chain, gaps(gap, len(chain)))
    half_width = positions[-1] + largest + length * math.sin(math.radians(release))
    world = _beams(positions[0] - largest, positions[-1] + largest, spread)
    tendons: list[str] = []
    state: list[float] = []
    for i, (ball, x) in enumerate(zip(chain, positions, strict=True), start=1):
        world += _hanging(i, ball, x, length, spread, kinds(chain)[ball])
        tendons += _strings(i, math.hypot(length - ball.radius, spread), timestep)
        state += _lifted(x, length, math.radians(release) if i <= released else 0.0)
    return document(
        name or f"two_string_{len(chain)}",
        world=world,
        view=camera(half_width, 2 * largest, -length - 2 * largest, spread),
        row=chain,
        extent=max(half_width, length),
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=[
            "<tendon>",
            *(f"  {line}" for line in tendons),
            "</tendon>",
            "<keyframe>",
            f'  <key name="release" qpos="{numbers(*state)}"/>',
            "</keyframe>",
        ],
    )


def free_balls(
    count: int,
    *,
    ball: Ball | None = None,
    speed: float = 1.0,
    distance: float = 0.1,
    spacing: float = 1.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    name: str | None = None,
) -> str:
    """Return the MJCF of loose balls without gravity, far apart, of which two collide.

    Ball 2 rests at `distance` to the right of ball 1, ball 1 flies towards it in the
    keyframe ``release``; the others rest on a square grid behind them (+y) and are
    never touched while ball 2 flies for a metre or so.

    Args:
        count: Number of balls, at least 2.
        ball: The ball all of them are; None: ball A.
        speed: Speed of ball 1 along +x in the keyframe ``release`` [m/s].
        distance: Gap between balls 1 and 2 at the start [m].
        spacing: Distance between the centres of the other balls [m].
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        name: Name of the model; None: ``free_balls_`` and `count`.
    """
    kind = ball or balls("A")[0]
    require_range("count", count, 2, 100_000)
    require_positive("distance [m]", distance)
    require_positive("spacing [m] minus the diameter", spacing - 2 * kind.radius)
    side = max(1, math.ceil(math.sqrt(count - 2)))
    half_width = max(distance, side * spacing / 2) + 2 * kind.radius
    places = [(0.0, 0.0), (2 * kind.radius + distance, 0.0)]
    for k in range(count - 2):
        column, line = k % side, k // side
        places.append(((column - (side - 1) / 2) * spacing, (line + 1) * spacing))
    world: list[str] = []
    for i, place in enumerate(places, start=1):
        world += _free(i, kind, (*place, 0.0), "steel_1")
    velocity = [speed] + [0.0] * (6 * count - 1)
    state = [v for x, y in places for v in (x, y, 0.0, 1.0, 0.0, 0.0, 0.0)]
    return document(
        name or f"free_balls_{count}",
        world=world,
        view=camera(half_width, half_width / 2, -half_width / 2, half_width),
        row=[kind],
        extent=half_width,
        timestep=timestep,
        integrator=integrator,
        gravity=0.0,
        after=[
            "<keyframe>",
            f'  <key name="release" qpos="{numbers(*state)}" '
            f'qvel="{numbers(*velocity)}"/>',
            "</keyframe>",
        ],
    )


def _beams(left: float, right: float, spread: float) -> list[str]:
    """Return the two bars the strings hang from."""
    return [
        f'<site name="beam_{side}" type="capsule" size="0.003" '
        f'fromto="{numbers(left, y, 0.0, right, y, 0.0)}"/>'
        for side, y in (("front", -spread), ("back", spread))
    ]


def _hanging(
    i: int, ball: Ball, x: float, length: float, spread: float, material: str
) -> list[str]:
    """Return a free ball with its eye, and the two hooks above it."""
    hooks = [
        f'<site name="hook_{side}_{i}" size="0.002" pos="{numbers(x, y, 0.0)}"/>'
        for side, y in (("front", -spread), ("back", spread))
    ]
    eye = (
        f'  <site name="eye_{i}" size="0.002" pos="{numbers(0.0, 0.0, ball.radius)}"/>'
    )
    body = _free(i, ball, (x, 0.0, -length), material)
    return [*hooks, *body[:-1], eye, body[-1]]


def _free(
    i: int, ball: Ball, position: tuple[float, float, float], material: str
) -> list[str]:
    """Return a body with a free joint and one sphere."""
    geom = (
        f'type="sphere" size="{number(ball.radius)}" mass="{number(ball.mass)}" '
        f'material="{material}"'
    )
    return free_body(f"ball_{i}", position, geom, joint=f"free_{i}")


def _strings(i: int, reach: float, timestep: float) -> list[str]:
    """Return the two strings of a ball, of length `reach` [m]."""
    # 2 h is the shortest time constant MuJoCo accepts (it clamps shorter ones).
    limit = (
        f'limited="true" range="{numbers(0.0, reach)}" '
        f'solreflimit="{numbers(2 * timestep, 1.0)}" solimplimit="0.95 0.99 0.0001"'
    )
    return [
        line
        for side in ("front", "back")
        for line in (
            f'<spatial name="string_{side}_{i}" width="0.0008" {limit}>',
            f'  <site site="hook_{side}_{i}"/>',
            f'  <site site="eye_{i}"/>',
            "</spatial>",
        )
    ]


def _lifted(x: float, length: float, angle: float) -> tuple[float, ...]:
    """Return position [m] and quaternion (w, x, y, z) of a ball lifted towards -x."""
    return (
        x - length * math.sin(angle),
        0.0,
        -length * math.cos(angle),
        # Turned about +y, the ball moves towards -x and its eye keeps facing the hooks.
        math.cos(angle / 2),
        0.0,
        math.sin(angle / 2),
        0.0,
    )
