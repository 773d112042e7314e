"""How long an impact of any shapes lasts and how it is shared: by their curvatures."""

import itertools

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mujoco_impact
from mujoco_impact.pulses import PulseReader

RADIUS, MASS, SPEED = 0.015, 0.1, 0.5
MODULUS = 2e11 / (2 * 0.91)
"""E* of two steel bodies [Pa]."""

# shape on a slide along x: geom attributes, half its length along x [m], its curvature
# there [1/m]
SHAPES = {
    "ball": (f'size="{RADIUS}"', RADIUS, 1 / RADIUS),
    # the principal radii at the end of the half-axis a are b²/a and c²/a
    "tip": ('type="ellipsoid" size=".03 .01 .02"', 0.03, 0.03 / (0.01 * 0.02)),
    "flank": ('type="ellipsoid" size=".01 .02 .03"', 0.01, 0.01 / (0.02 * 0.03)),
    "cylinder": ('type="cylinder" size=".02 .05"', 0.02, 1 / 0.02),
    "drum": ('type="cylinder" size=".05 .02" euler="0 90 0"', 0.02, 0),
    "capsule": ('type="capsule" size=".02 .05"', 0.02, 1 / 0.02),
    "face": ('type="box" size=".02 .03 .04"', 0.02, 0),
    # a twentieth of the smallest half-size; the cube stands on its edge
    "edge": ('type="box" size=".02 .02 .02" euler="0 0 45"', 0.02 * 2**0.5, 1 / 0.001),
    "mesh": ('type="mesh" mesh="brick"', 0.02, 0),
}

BRICK = " ".join(f"{x} {y} {z}" for x in (-2, 2) for y in (-3, 3) for z in (-4, 4))


def row(names) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Touching bodies on slides along x; the first comes from .2 mm away.

    They are a nanometre apart, for MuJoCo does not see an ellipsoid and a box that
    touch exactly.
    """
    bodies, x, before = "", 0.0, 0.0
    for i, name in enumerate(names):
        geom, half, _ = SHAPES[name]
        x += before + half + (1e-9 if i else 0)
        before = half
        start = x - (2e-4 if i == 0 else 0)
        bodies += (
            f'<body pos="{start!r} 0 0"><joint type="slide" axis="1 0 0"/>'
            f'<geom name="{i}" {geom} mass="{MASS}"/></body>'
        )
    xml = f"""
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <asset><mesh name="brick" scale=".01 .01 .01" vertex="{BRICK}"/></asset>
  <worldbody>{bodies}</worldbody>
</mujoco>"""
    model = mujoco_impact.attach(xml, touch=1e-8, friction="none").compile()
    data = mujoco.MjData(model)
    data.qvel[0] = SPEED
    return model, data


def hertz_stiffness(first, second) -> float:
    return 4 / 3 * MODULUS / np.sqrt(SHAPES[first][2] + SHAPES[second][2])


@pytest.mark.parametrize("shape", SHAPES)
def test_a_ball_touches_for_the_hertz_time_of_the_curvatures(shape):
    model, data = row(["ball", shape])
    reader = PulseReader(model, data)
    mujoco.mj_step(model, data, 3)
    reader.poll()
    (impact,) = reader.impacts
    # T = 2.943 y/u, y the largest compression of the reduced mass m/2
    y = (5 / 4 * (MASS / 2) * SPEED**2 / hertz_stiffness("ball", shape)) ** 0.4
    assert impact.duration == pytest.approx(2.9432751843247047 * y / SPEED, rel=1e-6)


def shared(names) -> np.ndarray:
    """Velocities of a touching row after the impact, by DOP853 [m/s]."""
    n = len(names)
    K = np.array([hertz_stiffness(*pair) for pair in itertools.pairwise(names)])

    def rates(_, state):
        # in units of 10 um and 10 us, so that numbers are of the order 1
        x, v = state[:n] * 1e-5, state[n:]
        force = K * np.maximum(0, -np.diff(x)) ** 1.5
        a = np.zeros(n)
        a[:-1] -= force / MASS
        a[1:] += force / MASS
        return np.concatenate([v, a * 1e-5])

    start = np.zeros(2 * n)
    start[n] = SPEED
    end = solve_ivp(
        rates, (0, 200), start, "DOP853", rtol=1e-10, atol=1e-10, max_step=1
    )
    return end.y[n:, -1]


@pytest.mark.parametrize(
    "names",
    [
        ("ball", "tip", "face"),
        ("ball", "flank", "ball"),
        ("face", "ball", "edge"),
        ("ball", "mesh", "tip"),
        ("cylinder", "ball", "drum"),
        ("capsule", "ball", "flank", "ball"),
    ],
)
def test_bodies_share_an_impact_as_their_stiffnesses_say(names):
    model, data = row(names)
    mujoco.mj_step(model, data, 5)
    expected = shared(names)
    # equal stiffnesses would give other velocities
    assert np.abs(data.qvel - expected).max() < 1e-5 * SPEED
