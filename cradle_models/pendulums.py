"""Balls on massless rigid arms: a row (1 degree of freedom each) and a lattice (2).

Conventions: the row lies along +x, gravity along -z, pivots at z = 0. Joint angle 0 is
the hanging ball; a positive angle moves the ball towards +x (lattice, second joint:
towards +y), so length * joint velocity is the speed of the hanging ball along the row.
"""

import math
from collections.abc import Sequence
from typing import Literal

from cradle_models.ball import Ball, balls, centres, gaps
from cradle_models.checks import require_positive, require_range
from cradle_models.errors import ModelValueError
from cradle_models.scene import Integrator, camera, document, kinds, number, numbers


def row(
    pattern: str | Sequence[Ball],
    *,
    length: float = 0.3,
    release: float = 30.0,
    released: int = 1,
    gap: float | Sequence[float] = 0.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str | None = None,
) -> str:
    """Return the MJCF of a row of balls on hinges, a Newton's cradle in a plane.

    Each ball is a solid sphere fixed to a massless arm, so its moment of inertia about
    the hinge is m L^2 + 2/5 m r^2. There is no friction (condim 1), no damping and no
    floor. ``qpos0`` is the hanging row; the keyframe ``release`` lifts `released` balls
    at the left end.

    Args:
        pattern: Letters A and B, or the balls, left to right.
        length: Distance from the hinge to the centre of the ball [m].
        release: Angle by which the released balls are lifted [deg], 0 to 179.
        released: Number of balls lifted, 0 to the number of balls.
        gap: Gap between neighbours at rest [m], one for all or one for each pair;
            0: they touch, to the rounding of their positions.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model; None: ``row_`` and the number of balls.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    chain = balls(pattern)
    require_positive("length [m]", length)
    require_range("release [deg]", release, 0.0, 179.0)
    require_range("released", released, 0, len(chain))
    positions = centres(chain, gaps(gap, len(chain)))
    largest = max(ball.radius for ball in chain)
    swing = length * math.sin(math.radians(min(release, 90.0)))
    half_width = positions[-1] + largest + swing
    top = max(0.0, -length * math.cos(math.radians(release))) + 2 * largest
    lifted = -math.radians(release)
    angles = [lifted if i < released else 0.0 for i in range(len(chain))]
    beam = numbers(positions[0] - largest, 0.0, 0.0, positions[-1] + largest, 0.0, 0.0)
    world = [f'<site name="beam" type="capsule" size="0.003" fromto="{beam}"/>']
    for i, (ball, x) in enumerate(zip(chain, positions, strict=True), start=1):
        world += pendulum(str(i), ball, (x, 0.0), length, kinds(chain)[ball], ("",))
    return document(
        name or f"row_{len(chain)}",
        world=world,
        view=camera(half_width, top, -length - 2 * largest, largest),
        row=chain,
        extent=max(half_width, length),
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=_release(angles),
    )


def lattice(
    rows: int,
    columns: int,
    *,
    ball: Ball | None = None,
    length: float = 0.3,
    release: float = 30.0,
    released: Literal["column", "corner"] = "column",
    gap: float = 0.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str | None = None,
) -> str:
    """Return the MJCF of a lattice of pendulums that swing in x and in y.

    Each ball hangs on two crossed hinges in one pivot and touches its neighbours in x
    and in y. ``ball_2_3`` is row 2 (second from the front, y) and column 3 (third from
    the left, x); its joints are ``hinge_x_2_3`` (moves it along x) and ``hinge_y_2_3``.

    Args:
        rows: Number of balls along y, at least 1.
        columns: Number of balls along x, at least 1.
        ball: The ball all of them are; None: ball A.
        length: Distance from the pivot to the centre of the ball [m].
        release: Angle of the lifted balls in the keyframe ``release`` [deg], 0 to 80.
        released: Lift the left ``column`` towards -x, or the front left ``corner`` ball
            along the diagonal, so that it hits two neighbours at once.
        gap: Gap between neighbours at rest [m].
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model; None: ``lattice_`` rows ``x`` columns.
    """
    kind = ball or balls("A")[0]
    require_range("rows", rows, 1, 10_000)
    require_range("columns", columns, 1, 10_000)
    require_positive("length [m]", length)
    require_range("release [deg]", release, 0.0, 80.0)
    if released not in ("column", "corner"):
        raise ModelValueError(
            f"released = {released!r}; allowed: 'column' and 'corner'"
        )
    xs = centres([kind] * columns, gaps(gap, columns))
    ys = centres([kind] * rows, gaps(gap, rows))
    world: list[str] = []
    angles: list[float] = []
    for r, y in enumerate(ys, start=1):
        for c, x in enumerate(xs, start=1):
            label = f"{r}_{c}"
            world += pendulum(label, kind, (x, y), length, "steel_1", ("x_", "y_"))
            angles += _lattice_angles(release, released, r, c)
    half_width = xs[-1] + kind.radius + length * math.sin(math.radians(release))
    return document(
        name or f"lattice_{rows}x{columns}",
        world=world,
        view=camera(half_width, 0.05, -length - 2 * kind.radius, 2 * half_width),
        row=[kind],
        extent=max(half_width, length),
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=_release(angles),
    )


def _lattice_angles(
    release: float, released: str, row_index: int, column_index: int
) -> tuple[float, float]:
    """Return the angles [rad] of one lattice ball in the keyframe ``release``."""
    lift = math.radians(release)
    if released == "column":
        return (-lift if column_index == 1 else 0.0, 0.0)
    if row_index != 1 or column_index != 1:
        return (0.0, 0.0)
    # The first hinge carries the second one: the ball is at
    # length (sin a cos b, sin b, -cos a cos b). On the diagonal sin b = sin a cos b,
    # and it is lifted by cos a cos b = cos(lift).
    b = -math.asin(math.sin(lift) / math.sqrt(2))
    a = -math.acos(math.cos(lift) / math.cos(b))
    return (a, b)


def pendulum(
    label: str,
    ball: Ball,
    pivot: tuple[float, float],
    length: float,
    material: str,
    hinges: Sequence[str],
) -> list[str]:
    """Return the body of one pendulum; the arm is a site, so it weighs nothing."""
    axes = {"": "0 -1 0", "x_": "0 -1 0", "y_": "1 0 0"}
    arm = numbers(0.0, 0.0, 0.0, 0.0, 0.0, -length)
    return [
        f'<body name="ball_{label}" pos="{numbers(*pivot, 0.0)}">',
        *(
            f'  <joint name="hinge_{hinge}{label}" type="hinge" axis="{axes[hinge]}"/>'
            for hinge in hinges
        ),
        f'  <geom name="ball_{label}" type="sphere" size="{number(ball.radius)}" '
        f'mass="{number(ball.mass)}" pos="{numbers(0.0, 0.0, -length)}" '
        f'material="{material}"/>',
        f'  <site name="arm_{label}" type="capsule" size="0.0008" fromto="{arm}"/>',
        "</body>",
    ]


def _release(angles: Sequence[float]) -> list[str]:
    """Return the keyframe with the lifted balls."""
    return [
        "<keyframe>",
        f'  <key name="release" qpos="{numbers(*angles)}"/>',
        "</keyframe>",
    ]
