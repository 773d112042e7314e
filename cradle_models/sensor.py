"""A ball on a string that swings against a fixed force sensor behind an acrylic plate.

The set-up of Dondo and Noborio, section 3: the ball hits the plate at the lowest
point of its swing. Conventions as for the rows: the ball swings along x, gravity along
-z, the pivot at z = 0, angle 0 is the hanging ball, lifted balls have negative angles.
"""

import math
from collections.abc import Sequence

from cradle_models.ball import A, Ball
from cradle_models.checks import require_positive
from cradle_models.errors import ModelValueError
from cradle_models.pendulums import pendulum
from cradle_models.scene import Integrator, camera, document, number, numbers

#: Heights from which the ball is let go [m]: impacts at 0.31 to 0.89 m/s.
HEIGHTS = (0.005, 0.008, 0.011, 0.014, 0.018, 0.022, 0.026, 0.030, 0.035, 0.040)

PLATE_THICKNESS = 0.005
PLATE_HALF_WIDTH = 0.02
SENSOR_LENGTH = 0.03

#: 40 kHz, the rate of the sensor [Dondo and Noborio, section 3.1].
SAMPLE = 2.5e-5


def force_sensor(
    *,
    ball: Ball = A,
    length: float = 0.3,
    heights: Sequence[float] = HEIGHTS,
    timestep: float = SAMPLE,
    integrator: Integrator = "Euler",
    gravity: float = 9.81,
    name: str = "force_sensor",
) -> str:
    """Return the MJCF of a ball on a taut string in front of a fixed plate.

    The string is a massless arm. Ball (``ball_1``) and plate (``plate``) touch when the
    ball hangs. The keyframes ``shot_1``, ``shot_2`` ... lift the ball to each of the
    heights; ``release`` is the first of them.

    Args:
        ball: The ball.
        length: Distance from the pivot to the centre of the ball [m].
        heights: Heights of the centre above its lowest point [m], above 0, below
            `length`.
        timestep: Timestep [s].
        integrator: MuJoCo integrator.
        gravity: Gravity along -z [m/s^2].
        name: Name of the model.

    Raises:
        ModelValueError: A parameter lies outside its range.
    """
    require_positive("length [m]", length)
    if not heights:
        raise ModelValueError("heights is empty; at least 1 height is needed")
    for height in heights:
        if not (math.isfinite(height) and 0 < height < length):
            raise ModelValueError(
                f"height = {height} m; allowed: above 0, below the length {length} m"
            )
    angles = [-math.acos(1 - height / length) for height in heights]
    world = [
        *pendulum("1", ball, (0.0, 0.0), length, "steel_1", ("",)),
        *_sensor(ball.radius, length),
    ]
    reach = length * math.sin(max(map(abs, angles))) + ball.radius
    return document(
        name,
        world=world,
        view=camera(reach, 2 * ball.radius, -length - 2 * ball.radius, ball.radius),
        row=[ball],
        extent=length,
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        after=_shots(angles),
    )


def _sensor(radius: float, length: float) -> list[str]:
    """Return the plate, and the sensor and its bar behind it, which only show."""
    front, half = radius, PLATE_THICKNESS / 2
    behind = front + PLATE_THICKNESS
    width = PLATE_HALF_WIDTH
    axis = numbers(behind, 0.0, -length, behind + SENSOR_LENGTH, 0.0, -length)
    bar = numbers(behind + SENSOR_LENGTH, 0.0, -length)
    return [
        f'<geom name="plate" type="box" pos="{numbers(front + half, 0.0, -length)}" '
        f'size="{numbers(half, width, width)}" rgba="0.6 0.8 0.9 0.5"/>',
        f'<site name="sensor" type="cylinder" size="{number(width)}" fromto="{axis}"/>',
        f'<site name="bar" type="box" pos="{bar}" '
        f'size="{numbers(0.005, 2 * width, 2 * width)}"/>',
    ]


def _shots(angles: Sequence[float]) -> list[str]:
    """Return the keyframes."""
    keys = [("release", angles[0])]
    keys += [(f"shot_{shot}", angle) for shot, angle in enumerate(angles, start=1)]
    lines = [f'  <key name="{name}" qpos="{number(angle)}"/>' for name, angle in keys]
    return ["<keyframe>", *lines, "</keyframe>"]
