"""The summary: what is compared with what."""

from __future__ import annotations

import math

from mujoco_impact_lab.bench.mujoco_methods import DEFAULT, OURS
from mujoco_impact_lab.bench.points import Point
from mujoco_impact_lab.bench.summary import Summary, summarize


def point(method: str, cost: float, error: float, setting: str = "defaults") -> Point:
    return Point(
        "S1", method, setting, "Euler", 2e-3, cost=cost, velocity_error=error
    )  # fmt: skip


def only(*points: Point) -> Summary:
    (summary,) = summarize(points)
    return summary


def test_best_of_ours_within_the_budget_meets_mujoco_at_no_more_cost() -> None:
    """What costs more than ours does not count, nor do engines or references."""
    summary = only(
        point(OURS, 0.3, 1e-4),
        point(OURS, 1.1, 1e-5),
        point(OURS, 1.3, 1e-6),
        point(DEFAULT, 1.0, 0.4),
        point("mujoco-damper", 1.1, 0.02, "as dear"),
        point("mujoco-hertz", 1.15, 0.001, "dearer"),
        point("pymunk", 0.5, 0.005),
        Point("S1", "compiled-hertz", "", "", cost=0.1, velocity_error=1e-9,
              comparable=False),
    )  # fmt: skip
    assert (summary.cost, summary.ours) == (1.1, 1e-5)
    assert (summary.default, summary.mujoco) == (0.4, 0.02)
    assert summary.mujoco_setting == "mujoco-damper, 2 ms, Euler, as dear"
    assert summary.advantage == 0.02 / 1e-5
    assert (summary.engine_name, summary.engine, summary.engine_cost) == (
        "pymunk", 0.005, 0.5,
    )  # fmt: skip
    assert summary.beaten == ()


def test_defaults_count_even_if_ours_is_cheaper() -> None:
    """At the run time of the defaults every setting of that run time is a rival."""
    summary = only(point(OURS, 0.3, 1e-4), point("mujoco-damper", 0.99, 0.02))
    assert summary.mujoco == 0.02


def test_cheapest_of_ours_counts_where_all_are_dear() -> None:
    """And MuJoCo may spend as much."""
    summary = only(
        point(OURS, 2.0, 1e-4), point(OURS, 3.0, 1e-5), point("mujoco-damper", 1.9, 0.1)
    )
    assert (summary.cost, summary.advantage) == (2.0, 0.1 / 1e-4)


def test_a_point_of_ours_that_is_beaten_is_named() -> None:
    """By what is both faster and more accurate, not by what is only one of them."""
    summary = only(
        point(OURS, 1.0, 1e-5),
        point(OURS, 2.0, 1e-6),
        point(OURS, 2.1, 1e-4, "worse than our own"),
        point("exudyn", 1.5, 1e-4, "faster"),
        point("exudyn", 2.5, 1e-9, "more accurate"),
        point("exudyn", 1.9, 1e-7, "both"),
    )
    assert summary.beaten == (
        "ours, 2 ms, Euler by exudyn, 2 ms, Euler, both",
        "ours, 2 ms, Euler, worse than our own by exudyn, 2 ms, Euler, both",
    )
    assert (summary.points, summary.front_beaten) == (3, 1)


def test_scenes_without_us_or_without_rivals_do_not_break_it() -> None:
    """No points, no summary; no rival, no advantage."""
    assert summarize([]) == ()
    assert summarize([point(DEFAULT, 1.0, 0.4)]) == ()
    summary = only(point(OURS, 1.0, 1e-5))
    assert math.isnan(summary.advantage)
    assert math.isnan(summary.engine)
    assert summary.mujoco_setting == ""


def test_no_error_at_all_is_infinitely_better() -> None:
    """And what failed, so that it has no cost, does not count."""
    failed = point("mujoco-damper", math.nan, 1e-9)
    summary = only(point(OURS, 1.0, 0.0), point(DEFAULT, 1.0, 0.4), failed)
    assert summary.advantage == math.inf
