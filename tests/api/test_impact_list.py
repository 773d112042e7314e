"""Impacts as they are told: points put together, small ones in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from mujoco_impact import attach, compare, run
from mujoco_impact.impact import Impact
from mujoco_impact.impact_list import listed

BALL = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body pos="0 0 .25"><freejoint/><geom name="ball" size=".05" condim="1"/></body>
  </worldbody>
</mujoco>
"""


def impact(time: float, pair: str, speed: float) -> Impact:
    """Returns an impact of two geoms that have one letter each."""
    one, other = pair
    numbers = (speed, 1.0, 1.0, 1e-4, 1.0, speed)
    return Impact(time, (one, other), *numbers, speed, (0.0,) * 3, (1.0, 0.0, 0.0))


def test_a_ball_that_bounces_out_is_a_few_impacts_and_one_line() -> None:
    """0.6 of the speed each time: four or five above a tenth of the first."""
    motion = run(attach(BALL, restitution=0.6), duration=3.0)
    large, (small,) = listed(motion.impacts, timestep=motion.timestep, end=3.0)
    speeds = [one.closing_speed for one in large]
    assert 4 <= len(speeds) <= 5
    assert speeds[1:] == pytest.approx([0.6 * speed for speed in speeds[:-1]], rel=0.01)
    assert len(motion.impacts) == len(large) + small.count
    assert small.over
    assert f"comes to rest at {motion.impacts[-1].time:.3f} s" in str(small)
    # a comparison counts those that a run lists, one by one
    compared = compare(BALL, duration=3.0, repeats=1, settings={"restitution": 0.6})
    assert compared.table()[0]["impacts"] == len(large)


def test_points_of_a_step_are_one_impact_and_few_small_ones_stay() -> None:
    """Two corners at once; two small ones in a row are no row."""
    impacts = (
        impact(0.1, "ab", 1.0),
        impact(0.1001, "ba", 0.5),
        impact(0.2, "ab", 0.01),
        impact(0.3, "ac", 0.02),
        *(impact(0.4 + 0.01 * i, "cd", 0.03) for i in range(5)),
    )
    large, (small,) = listed(impacts, timestep=0.002, end=0.45)
    assert [(one.geoms, one.points) for one in large] == [
        (("a", "b"), 2),
        (("a", "b"), 1),
        (("a", "c"), 1),
    ]
    assert large[0].impulse == 1.5
    assert (small.count, small.over) == (5, False)
    assert str(small).endswith("from 0.400 s, on to the end")
    assert listed((), timestep=0.002, end=1.0) == ([], [])


def test_a_notebook_shows_the_impacts(tmp_path: Path) -> None:
    """As HTML, with names that cannot be markup; and a picture."""
    scene = BALL.replace('"ball"', '"&lt;b&gt;"')
    motion = run(attach(scene, restitution=0.6), duration=1.0)
    html = motion._repr_html_()
    assert "&lt;b&gt;" in html
    assert "<b>" not in html
    assert "closing speed" in html
    motion.plot(tmp_path / "motion.png")
    assert (tmp_path / "motion.png").read_bytes().startswith(b"\x89PNG")
