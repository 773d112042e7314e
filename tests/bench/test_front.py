"""The front: exactly the points that no other one beats."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mujoco_impact_lab.bench.points import Point, front, front_of

# few different values, so that ties are common
VALUES = st.sampled_from([0.0, 1.0, 2.0, 3.0, 5.0, math.inf, math.nan])
PAIRS = st.lists(st.tuples(VALUES, VALUES), max_size=12)


def beats(one: tuple[float, float], other: tuple[float, float]) -> bool:
    """The definition, word for word."""
    return (
        one[0] <= other[0]
        and one[1] <= other[1]
        and (one[0] < other[0] or one[1] < other[1])
    )


@given(PAIRS)
def test_front_is_what_no_other_pair_beats(pairs: list[tuple[float, float]]) -> None:
    """By definition, in any order, with ties, infinities and unknown numbers."""
    known = [i for i, pair in enumerate(pairs) if not any(map(math.isnan, pair))]
    expected = {
        i
        for i in known
        if math.isfinite(pairs[i][1])
        and not any(beats(pairs[j], pairs[i]) for j in known)
    }
    assert set(front(pairs)) == expected


@given(PAIRS)
def test_front_falls(pairs: list[tuple[float, float]]) -> None:
    """Whoever pays more gets less error: that is how it is drawn."""
    chosen = [pairs[index] for index in front(pairs)]
    assert chosen == sorted(chosen, key=lambda pair: (pair[0], -pair[1]))
    assert [error for _, error in chosen] == sorted(
        (error for _, error in chosen), reverse=True
    )


def test_references_are_not_on_the_front() -> None:
    """What is no simulator may be cheap and exact, and does not compete."""
    points = [
        Point("S1", "ours", "", "Euler", cost=1.0, velocity_error=1e-5),
        Point("S1", "other", "", "Euler", cost=2.0, velocity_error=1e-4),
        Point("S1", "bound", "", "", cost=0.1, velocity_error=1e-9, comparable=False),
        Point("S1", "failed", "", "Euler", failure="diverged"),
    ]
    assert [point.method for point in front_of(points, "velocity_error")] == ["ours"]
    assert front_of(points, "angle_rms") == []


def test_unknown_error_name_is_an_error() -> None:
    """Rather than an empty front."""
    points = [Point("S1", "ours", "", "Euler", cost=1.0)]
    with pytest.raises(AttributeError):
        front_of(points, "velocity")
