"""What an impact says of itself, and impacts as a table."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mujoco_impact import attach, run
from mujoco_impact.impact import impact_columns, impacts_table

# a ball of radius 30 mm thrown down at a plate that leans by 0.3 rad
SLOPE = """
<mujoco>
  <option timestep="0.002" gravity="0 0 -9.81" integrator="{integrator}"/>
  <worldbody>
    <geom name="plate" type="{kind}" size="1 1 .1" pos="0 0 {z}" euler="0 0.3 0"/>
    <body name="ball" pos=".1 .05 .5"><freejoint/>
      <geom name="ball" size=".03" mass=".2" condim="1"/></body>
  </worldbody>
  <compiler angle="radian"/>
</mujoco>
"""
NORMAL = np.array([math.sin(0.3), 0.0, math.cos(0.3)])


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
@pytest.mark.parametrize("kind", ["plane", "box"])
def test_an_impact_says_where_how_fast_and_in_which_direction(
    kind: str, integrator: str
) -> None:
    """The closed form of a fall, on a plane and on the top of a box."""
    z = "0" if kind == "plane" else repr(-0.1 / math.cos(0.3))
    scene = SLOPE.format(kind=kind, z=z, integrator=integrator)
    motion = run(
        attach(scene, restitution=0.8, friction="none"),
        duration=0.4,
        qvel=[0.5, *[0] * 5],
    )
    impact = motion.impacts[0]
    # n . x(t) = r, x(t) the centre
    start, drop = np.array([0.1, 0.05, 0.5]), np.array([0.0, 0.0, -9.81])
    roots = np.roots([0.5 * NORMAL @ drop, 0.5 * NORMAL[0], NORMAL @ start - 0.03])
    time = float(roots.max())
    centre = start + time * np.array([0.5, 0.0, 0.0]) + time**2 / 2 * drop
    speed = -float(NORMAL @ ([0.5, 0.0, 0.0] + time * drop))
    # Euler falls h/2 g t deeper and the contact path is of first order off planes
    exact = integrator == "RK4"
    assert impact.time == pytest.approx(time, abs=1e-5 if exact else 2e-3)
    assert impact.closing_speed == pytest.approx(speed, rel=1e-4 if exact else 1e-2)
    assert impact.position == pytest.approx(
        centre - 0.03 * NORMAL, abs=1e-5 if exact else 3e-3
    )
    on_second = 1 if impact.geoms[1] == "ball" else -1
    assert on_second * np.array(impact.normal) == pytest.approx(NORMAL, abs=1e-9)
    assert impact.tangential_impulse == (0.0, 0.0, 0.0)
    # mu (1 + e) u of what is recorded, to the weight during the contact
    assert impact.impulse == pytest.approx(0.2 * 1.8 * impact.closing_speed, rel=1e-3)


def test_friction_shows_in_the_tangential_impulse() -> None:
    """Against the slip, along the surface, of the size of factor times impulse."""
    scene = SLOPE.format(kind="plane", z=0, integrator="Euler")
    spec = attach(scene, friction="paper", mu_s=0.5, mu_d=0.3)
    impact = run(spec, duration=0.4, qvel=[2.0, *[0.0] * 5]).impacts[0]
    tangential = np.array(impact.tangential_impulse)
    part = np.linalg.norm(tangential) / impact.impulse
    assert 0.2 < part < 0.5
    assert tangential @ np.array(impact.normal) == pytest.approx(0.0, abs=1e-12)
    on_ball = tangential if impact.geoms[1] == "ball" else -tangential
    assert on_ball[0] < 0


@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_the_force_over_time_has_the_impulse_and_the_height(
    two_balls: str, restitution: float
) -> None:
    """Nothing before, nothing after; the integral by midpoints."""
    spec = attach(two_balls, restitution=restitution, duration=4e-3)
    (impact,) = run(spec, duration=0.02, keyframe="shot").impacts
    cells = 4000
    time = impact.time + impact.duration * (np.arange(cells) + 0.5) / cells
    force = impact.force(time)
    # midpoints: the error is of the order of the cell squared
    assert force.mean() * impact.duration == pytest.approx(impact.impulse, rel=1e-6)
    assert force.max() == pytest.approx(impact.height, rel=1e-6)
    assert impact.force(impact.time - 1e-4) == 0.0
    assert impact.force(impact.time + impact.duration + 1e-4) == 0.0


def test_impacts_are_a_structured_array(two_balls: str) -> None:
    """Every field of an impact is a column, vectors with three components."""
    impacts = run(attach(two_balls), duration=0.02, keyframe="shot").impacts
    table = impacts_table(impacts)
    assert table["geom1"].tolist() == [impacts[0].geoms[0]]
    assert table["closing_speed"][0] == pytest.approx(1.0)
    assert table["position"].shape == (1, 3)
    columns = impact_columns(impacts)
    assert columns["normal_x"][0] == impacts[0].normal[0]
    assert "normal" not in columns
    assert impacts_table(()).shape == (0,)
    assert impacts_table(()).dtype.names == table.dtype.names
