"""Boxes that stand on a floor with friction: a row of dominoes, a rocking block.

Every model stands when loaded. Its keyframe ``release`` pushes or tilts it.
"""

import math

from cradle_models.checks import require_not_negative, require_positive, require_range
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


def dominoes(
    count: int = 12,
    *,
    height: float = 0.048,
    width: float = 0.024,
    thickness: float = 0.008,
    mass: float = 0.01,
    pitch: float = 0.036,
    push: float = 4.0,
    friction: float = 0.3,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str = "dominoes",
) -> str:
    """Return the MJCF of a row of dominoes that fall along +x.

    The stones are free: friction alone keeps their feet in place, and rubs where one
    leans on the next.

    Args:
        count: Number of stones, ``stone_1`` is the first.
        height: Height of a stone [m].
        width: Width across the row [m].
        thickness: Thickness along the row [m], less than `pitch`.
        mass: Mass of a stone [kg].
        pitch: Distance from a stone to the next, centre to centre [m]; less than
            `height`, or they do not reach each other.
        push: How fast the first turns about its lower front edge in the keyframe
            ``release`` [rad/s].
        friction: Coefficient of Coulomb friction, on the floor and between stones.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    require_range("count", count, 1, 10_000)
    for label, value in (("height", height), ("width", width), ("mass", mass)):
        require_positive(label, value)
    require_positive("thickness [m]", thickness)
    require_range("pitch [m]", pitch, thickness, height)
    require_not_negative("friction", friction)
    size = numbers(thickness / 2, width / 2, height / 2)
    stone = f'type="box" size="{size}" mass="{number(mass)}" material="colour_4"'
    half = (count - 1) * pitch / 2
    places = [(i * pitch - half, 0.0, height / 2) for i in range(count)]
    world = [FLOOR]
    for i, place in enumerate(places, start=1):
        world += free_body(f"stone_{i}", place, stone)
    # about the lower front edge: v = omega x (centre - edge)
    pushed = [push * height / 2, 0.0, push * thickness / 2, 0.0, push, 0.0]
    eye = numbers(height, -(1.4 * half + 4 * height), 0.6 * half + 2 * height)
    return document(
        name,
        world=world,
        view=f'<camera name="view" pos="{eye}" xyaxes="1 0 0 0 0.4 0.92"/>',
        materials=COLOURS,
        geom=f'<geom friction="{number(friction)}"/>',
        extent=half + 2 * height,
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=start(places, pushed + [0.0] * (6 * (count - 1))),
    )


def rocking_block(
    *,
    half_width: float = 0.05,
    half_height: float = 0.2,
    half_depth: float = 0.05,
    density: float = 2000.0,
    tilt: float = 0.5,
    friction: float = 1.0,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str = "rocking_block",
) -> str:
    """Return the MJCF of a block that rocks from one lower edge to the other.

    Housner's problem (1963): without a rebound, each time that it comes upright it
    passes on the fraction ``1 - 3/2 sin(alpha)^2`` of its angular velocity, where
    ``tan(alpha) = half_width / half_height``. At the angle alpha it would fall over.

    Args:
        half_width: Half of the width along x [m].
        half_height: Half of the height [m].
        half_depth: Half of the depth along y [m].
        density: Density [kg/m^3].
        tilt: Angle about the lower right edge in the keyframe ``release``, as a
            fraction of alpha, 0 to below 1.
        friction: Coefficient of Coulomb friction; below about 0.5 slender blocks slide.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    for label, value in (
        ("half_width [m]", half_width),
        ("half_height [m]", half_height),
        ("half_depth [m]", half_depth),
        ("density [kg/m^3]", density),
    ):
        require_positive(label, value)
    require_range("tilt", tilt, 0.0, 0.99)
    require_not_negative("friction", friction)
    size = numbers(half_width, half_depth, half_height)
    block = f'type="box" size="{size}" density="{number(density)}" material="colour_1"'
    alpha = math.atan2(half_width, half_height)
    angle = tilt * alpha
    reach = math.hypot(half_width, half_height)
    # the centre is at alpha - angle from the vertical, as seen from the edge
    lean = alpha - angle
    centre = (half_width - reach * math.sin(lean), 0.0, reach * math.cos(lean))
    turn = (math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0)
    return document(
        name,
        world=[FLOOR, *free_body("block", (0.0, 0.0, half_height), block)],
        view=camera(
            1.2 * reach, 2.3 * reach, -0.2 * reach, 2 * half_depth, name="view"
        ),
        materials=COLOURS,
        geom=f'<geom friction="{number(friction)}"/>',
        extent=2 * reach,
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=start([centre], [0.0] * 6, [turn]),
    )
