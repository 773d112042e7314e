"""A pool table: cloth, cushions, six pockets that balls fall into, a rack.

The table lies in the x-y plane, the cloth at z = 0, its long sides along x. All balls
rest when loaded. The keyframe ``release`` gives the cue ball its speed.
"""

import math

from cradle_models.ball import Ball
from cradle_models.checks import require_not_negative, require_range
from cradle_models.scene import (
    Integrator,
    Place,
    document,
    free_body,
    number,
    numbers,
    start,
)

#: A pool ball: 2.25 in across, 6 oz [Alciatore, physical properties].
POOL = Ball(mass=0.17, radius=0.028575)

#: Widths of the pockets between the noses of the cushions [m] [WPA].
CORNER_MOUTH, SIDE_MOUTH = 0.116, 0.129

#: Radius of the noses of the cushions [m].
NOSE_RADIUS = 0.01

#: How fast a spin about the vertical decays on the cloth [rad/s^2] [Alciatore].
SPIN_DECAY = 10.0

#: From the nose line to the wall of the table [m]: a ball falls through in between.
RAIL = 0.1

#: Thickness of the bed, and depth of the floor below it [m].
BED, BELOW = 0.03, 0.12

#: Height of the cloth above the floor of the room [m].
HIGH = 0.8

#: Half of the thickness of the walls [m].
WALL = 0.015

BALL_COLOURS = (
    "1.00 0.80 0.10 1",
    "0.10 0.30 0.70 1",
    "0.85 0.10 0.10 1",
    "0.45 0.15 0.55 1",
    "1.00 0.50 0.10 1",
    "0.05 0.50 0.30 1",
    "0.55 0.10 0.15 1",
    "0.10 0.10 0.10 1",
)

_MATERIALS = (
    '<material name="cue" rgba="1 1 0.95 1" specular="0.8" shininess="0.9"/>',
    '<material name="cloth" rgba="0.10 0.42 0.34 1" specular="0" shininess="0"/>',
    '<material name="cushion" rgba="0.07 0.33 0.26 1" specular="0" shininess="0"/>',
    '<material name="wood" rgba="0.32 0.20 0.12 1" specular="0.3" shininess="0.5"/>',
    *(
        f'<material name="ball_{i}" rgba="{rgba}" specular="0.8" shininess="0.9"/>'
        for i, rgba in enumerate(BALL_COLOURS, start=1)
    ),
)


def billiards(
    rows: int = 5,
    *,
    ball: Ball = POOL,
    length: float = 2.54,
    width: float | None = None,
    speed: float = 6.0,
    offset: float = 0.0,
    gap: float = 0.0,
    nose: float = 0.27,
    friction: float = 0.06,
    cloth: float = 0.2,
    cushion: float = 0.14,
    rolling: float = 0.01,
    timestep: float = 0.002,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str = "billiards",
) -> str:
    """Return the MJCF of a pool table with a cue ball and a rack.

    The balls are free, slide, roll and spin on the cloth. The bed ends at the noses of
    the cushions: a ball that passes between two of them falls into the pocket, and lies
    below. The frictions are those of MuJoCo's contacts, which have the larger one of
    two geoms: let that of the balls be the smallest.

    Args:
        rows: Rows of the rack, 0 to 5: 0, 1, 3, 6, 10 or 15 balls, ``ball_1`` at the
            foot spot; the cue ball ``cue`` is at the head spot.
        ball: The ball all of them are.
        length: Length of the table along x between the noses of the cushions [m].
        width: Its width along y [m]; None: half of the length.
        speed: Speed of the cue ball along +x in the keyframe ``release`` [m/s]. It
            does not spin yet, as hit in its middle.
        offset: How far the cue ball is moved along y [m].
        gap: Gap between neighbours of the rack [m].
        nose: How far above the centre of a ball the cushion touches it, in radii; 0:
            at the centre.
        friction: Coefficient of Coulomb friction between balls.
        cloth: That between ball and cloth.
        cushion: That between ball and cushion.
        rolling: Rolling resistance: deceleration of a ball that rolls over gravity.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    require_range("rows", rows, 0, 5)
    half_x, half_y = length / 2, (length / 2 if width is None else width) / 2
    shortest = 4 * (CORNER_MOUTH + SIDE_MOUTH)
    require_range("length [m]", length, shortest, math.inf)
    require_range("width [m]", 2 * half_y, shortest / 2, math.inf)
    require_range("ball.radius [m]", ball.radius, 0.005, 0.4 * RAIL)
    require_range("nose", nose, 0.0, 0.5)
    require_range("offset [m]", offset, ball.radius - half_y, half_y - ball.radius)
    for label, value in (
        ("gap [m]", gap),
        ("friction", friction),
        ("cloth", cloth),
        ("cushion", cushion),
        ("rolling", rolling),
    ):
        require_not_negative(label, value)
    places: list[Place] = [(-half_x / 2, offset, ball.radius)]
    places += _rack(rows, half_x / 2, ball.radius, gap)
    height = ball.radius + nose * (ball.radius + NOSE_RADIUS)
    world = [
        *_bed(half_x, half_y, _rubs(ball.radius, cloth, rolling)),
        *_cushions(half_x, half_y, height, cushion),
    ]
    look = f'type="sphere" size="{number(ball.radius)}" mass="{number(ball.mass)}"'
    for i, place in enumerate(places):
        label = f"ball_{i}" if i else "cue"
        colour = f"ball_{(i - 1) % len(BALL_COLOURS) + 1}" if i else "cue"
        world += free_body(label, place, f'{look} material="{colour}"')
    eye = numbers(0.0, round(-0.9 * half_x, 3), round(1.95 * half_x, 3))
    return document(
        name,
        world=world,
        view=f'<camera name="view" pos="{eye}" xyaxes="1 0 0 0 0.92 0.4"/>',
        materials=_MATERIALS,
        geom=f'<geom friction="{numbers(friction, 0.0, 0.0)}"/>',
        # with MuJoCo's default cone a ball with rolling resistance slips by 4 %
        option=' cone="elliptic"',
        extent=half_x,
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=start(places, [speed] + [0.0] * (6 * len(places) - 1)),
    )


def _rack(rows: int, x: float, radius: float, gap: float) -> list[Place]:
    """Return the places of a triangle of balls whose first is at `x`."""
    apart = 2 * radius + gap
    return [
        (x + row * apart * math.sqrt(0.75), (i - row / 2) * apart, radius)
        for row in range(rows)
        for i in range(row + 1)
    ]


def _rubs(radius: float, cloth: float, rolling: float) -> str:
    """Return the attributes of the friction of the cloth.

    MuJoCo's two other coefficients are lengths c that make torques c N. Rolling, it
    takes (rolling g) (7/5) m r to slow a ball by rolling g; to slow its spin by s,
    (2/5) m r^2 s.
    """
    drill = 0.4 * radius**2 * SPIN_DECAY / 9.81
    return f'condim="6" friction="{numbers(cloth, drill, 1.4 * rolling * radius)}"'


def _bed(half_x: float, half_y: float, rubs: str) -> list[str]:
    """Return the floor of the room, the bed, what is below it, and walls around both.

    Args:
        half_x: Half of the length of the table between the noses [m].
        half_y: Half of its width [m].
        rubs: Attributes of their friction.
    """
    outer_x, outer_y = half_x + RAIL + WALL, half_y + RAIL + WALL
    middle, tall = -BELOW / 2, BELOW / 2 + 0.05
    walls = (
        ("head", (-outer_x, 0.0), (WALL, outer_y + WALL)),
        ("foot", (outer_x, 0.0), (WALL, outer_y + WALL)),
        ("right", (0.0, -outer_y), (outer_x - WALL, WALL)),
        ("left", (0.0, outer_y), (outer_x - WALL, WALL)),
    )
    return [
        f'<geom name="bed" type="box" size="{numbers(half_x, half_y, BED / 2)}" '
        f'pos="{numbers(0.0, 0.0, -BED / 2)}" material="cloth" {rubs}/>',
        f'<geom name="floor" type="plane" size="4 4 0.1" '
        f'pos="{numbers(0.0, 0.0, -HIGH)}" rgba="0.62 0.68 0.74 1" {rubs}/>',
        f'<geom name="below" type="box" size="{numbers(outer_x, outer_y, 0.01)}" '
        f'pos="{numbers(0.0, 0.0, -BELOW - 0.01)}" rgba="0.1 0.1 0.1 1" {rubs}/>',
        *(
            f'<geom name="wall_{side}" type="box" size="{numbers(*size, tall)}" '
            f'pos="{numbers(*at, middle)}" material="wood"/>'
            for side, at, size in walls
        ),
    ]


def _cushions(half_x: float, half_y: float, z: float, friction: float) -> list[str]:
    """Return the six cushions: a round nose each, and what is behind it.

    Args:
        half_x: Half of the length of the table between the noses [m].
        half_y: Half of its width [m].
        z: Height of the axes of the noses above the cloth [m].
        friction: Coefficient of Coulomb friction.
    """
    # a corner is between the ends of two noses, one along x and one along y
    corner = (CORNER_MOUTH + 2 * NOSE_RADIUS) / math.sqrt(2) - NOSE_RADIUS
    side = SIDE_MOUTH / 2 + NOSE_RADIUS
    across_x, across_y = half_x + NOSE_RADIUS, half_y + NOSE_RADIUS
    long = (side + half_x - corner) / 2
    noses = [
        (f"{where}_{end}", (sign * long, turn * across_y), half_x - corner - long, 0)
        for where, turn in (("right", -1), ("left", 1))
        for end, sign in (("head", -1), ("foot", 1))
    ]
    noses += [
        (where, (sign * across_x, 0.0), half_y - corner, 1)
        for where, sign in (("head", -1), ("foot", 1))
    ]
    lines: list[str] = []
    thick = (RAIL - NOSE_RADIUS) / 2
    tall = (z + NOSE_RADIUS) / 2
    for label, centre, half, axis in noses:
        ends = [list(centre), list(centre)]
        ends[0][axis] -= half
        ends[1][axis] += half
        # the block lies between the nose and the wall, away from the middle
        behind, size = list(centre), [half, half]
        behind[1 - axis] += math.copysign(thick, centre[1 - axis])
        size[1 - axis] = thick
        lines += [
            f'<geom name="cushion_{label}" type="capsule" '
            f'size="{number(NOSE_RADIUS)}" '
            f'fromto="{numbers(*ends[0], z, *ends[1], z)}" '
            f'material="cushion" friction="{numbers(friction, 0.0, 0.0)}"/>',
            f'<geom name="rail_{label}" type="box" size="{numbers(*size, tall)}" '
            f'pos="{numbers(*behind, tall)}" material="wood" '
            f'friction="{numbers(friction, 0.0, 0.0)}"/>',
        ]
    return lines
