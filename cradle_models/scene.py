"""The parts of an MJCF scene that all models share: options, looks, light, camera."""

import math
from collections.abc import Sequence
from typing import Literal
from xml.sax.saxutils import quoteattr

from cradle_models.ball import Ball
from cradle_models.checks import require_positive
from cradle_models.errors import ModelValueError

Integrator = Literal["Euler", "RK4", "implicit", "implicitfast", "discrete"]

#: Integrators of MuJoCo; ``discrete`` needs MuJoCo 4.
INTEGRATORS: tuple[Integrator, ...] = (
    "Euler",
    "RK4",
    "implicit",
    "implicitfast",
    "discrete",
)

#: Vertical opening of the camera [deg], and the width over height it is fitted to.
FIELD_OF_VIEW = 40.0
ASPECT = 4 / 3

# One shade of steel for each kind of ball in a scene, by order of appearance.
SHADES = ("0.66 0.68 0.72 1", "0.36 0.40 0.46 1", "0.62 0.54 0.40 1")

#: Materials of what is not of steel, ``colour_1`` and so on.
COLOURS = tuple(
    f'<material name="colour_{i}" rgba="{rgba}" specular="0.6" shininess="0.7"/>'
    for i, rgba in enumerate(
        (
            "0.90 0.55 0.20 1",
            "0.13 0.55 0.55 1",
            "0.75 0.25 0.30 1",
            "0.93 0.90 0.82 1",
        ),
        start=1,
    )
)

#: A floor at z = 0.
FLOOR = '<geom name="floor" type="plane" size="4 4 0.1" rgba="0.62 0.68 0.74 1"/>'

Place = tuple[float, float, float]
Turn = tuple[float, float, float, float]


def number(value: float) -> str:
    """Return the shortest text that reads back as the same float."""
    return repr(float(value))


def numbers(*values: float) -> str:
    """Return the values separated by spaces, each exact."""
    return " ".join(number(value) for value in values)


def kinds(row: Sequence[Ball]) -> dict[Ball, str]:
    """Return the material name of each kind of ball, by order of appearance."""
    different = tuple(dict.fromkeys(row))
    return {ball: f"steel_{i % len(SHADES) + 1}" for i, ball in enumerate(different)}


def camera(
    half_width: float,
    top: float,
    bottom: float,
    depth: float = 0.0,
    *,
    name: str = "cradle",
) -> str:
    """Return a camera in front of the x-z plane (looking along +y) that sees the box.

    Args:
        half_width: The box reaches from -half_width to +half_width in x [m].
        top: Highest z of the box [m].
        bottom: Lowest z of the box [m].
        depth: The box reaches from -depth to +depth in y [m].
        name: Name of the camera.
    """
    tangent = math.tan(math.radians(FIELD_OF_VIEW / 2))
    needed = max((top - bottom) / 2, half_width / ASPECT) / tangent
    distance = 1.1 * needed + depth
    return (
        f'<camera name="{name}" mode="fixed" fovy="{number(FIELD_OF_VIEW)}" '
        f'pos="{numbers(0.0, round(-distance, 3), round((top + bottom) / 2, 3))}" '
        'xyaxes="1 0 0 0 0 1"/>'
    )


def document(
    name: str,
    *,
    world: Sequence[str],
    view: str,
    row: Sequence[Ball] = (),
    materials: Sequence[str] = (),
    geom: str = '<geom condim="1"/>',
    option: str = "",
    extent: float,
    timestep: float,
    integrator: str,
    gravity: float,
    after: Sequence[str] = (),
) -> str:
    """Return a whole MJCF document.

    Args:
        name: Name of the model.
        world: Lines inside ``<worldbody>``, without indentation.
        view: The camera element.
        row: Balls of steel, each kind of which gets a material.
        materials: Further ``<material>`` elements.
        geom: What geoms have unless they say otherwise; by default no friction.
        option: Further attributes of ``<option>``, each after a space.
        extent: Half of the size of the scene [m].
        timestep: Timestep [s].
        integrator: One of `INTEGRATORS`.
        gravity: Gravity along -z [m/s^2], 0 allowed.
        after: Lines after ``</worldbody>``, without indentation.
    """
    require_positive("timestep [s]", timestep)
    if integrator not in INTEGRATORS:
        raise ModelValueError(f"integrator = {integrator!r}; allowed: {INTEGRATORS}")
    if not (math.isfinite(gravity) and gravity >= 0):
        raise ModelValueError(f"gravity [m/s^2] = {gravity}; allowed: finite and >= 0")
    steel = [
        f'<material name="{material}" rgba="{shade}" specular="0.9" shininess="0.9" '
        'reflectance="0.2"/>'
        for material, shade in zip(
            dict.fromkeys(kinds(row).values()), SHADES, strict=False
        )
    ]
    light = (
        f'<light name="lamp" pos="{numbers(0.0, -2 * extent, 2 * extent)}" '
        'dir="0 1 -1" directional="true"/>'
    )
    lines = [
        f"<mujoco model={quoteattr(name)}>",
        f'  <option timestep="{number(timestep)}" integrator="{integrator}" '
        f'gravity="{numbers(0.0, 0.0, -gravity)}"{option}/>',
        f'  <statistic extent="{number(round(extent, 3))}"/>',
        "  <visual>",
        '    <headlight ambient="0.3 0.3 0.3" diffuse="0.3 0.3 0.3"/>',
        # Taut strings are drawn in the colour of active limits: not in red here.
        '    <rgba constraint="0.35 0.35 0.38 1"/>',
        "  </visual>",
        "  <default>",
        f"    {geom}",
        '    <site group="0" rgba="0.35 0.35 0.38 1"/>',
        "  </default>",
        "  <asset>",
        '    <texture name="backdrop" type="skybox" builtin="gradient" '
        'rgb1="0.93 0.95 0.97" rgb2="0.70 0.74 0.80" width="32" height="192"/>',
        *(f"    {line}" for line in [*steel, *materials]),
        "  </asset>",
        "  <worldbody>",
        f"    {light}",
        f"    {view}",
        *(f"    {line}" for line in world),
        "  </worldbody>",
        *(f"  {line}" for line in after),
        "</mujoco>",
    ]
    return "\n".join(lines) + "\n"


def free_body(
    name: str, position: Place, geom: str, *, joint: str | None = None
) -> list[str]:
    """Return a free body with one geom of the same name.

    Args:
        name: Name of the body.
        position: Its place [m].
        geom: Attributes of the geom.
        joint: Name of its joint; None: ``free_`` and the name of the body.
    """
    return [
        f'<body name="{name}" pos="{numbers(*position)}">',
        f'  <freejoint name="{joint or f"free_{name}"}"/>',
        f'  <geom name="{name}" {geom}/>',
        "</body>",
    ]


def start(
    places: Sequence[Place],
    velocity: Sequence[float],
    turns: Sequence[Turn] | None = None,
) -> list[str]:
    """Return the keyframe ``release`` of free bodies.

    Args:
        places: Position of each [m].
        velocity: ``qvel``, six numbers for each [m/s] and [rad/s].
        turns: Quaternion (w, x, y, z) of each; None: upright.
    """
    upright = (1.0, 0.0, 0.0, 0.0)
    both = zip(places, turns or [upright] * len(places), strict=True)
    state = [value for place, turn in both for value in (*place, *turn)]
    return [
        "<keyframe>",
        f'  <key name="release" qpos="{numbers(*state)}" qvel="{numbers(*velocity)}"/>',
        "</keyframe>",
    ]
