"""The paper's tables as data: what they say about themselves."""

import numpy as np
import pytest

import cradle_models
from mujoco_impact.paper.patterns import drop_speed
from mujoco_impact.paper.printed import printed

ALL = cradle_models.PAPER_PATTERNS


def test_every_pattern_has_its_table_and_its_parameters():
    assert [printed(pattern).table for pattern in ALL] == list(range(4, 12))
    for pattern in ALL:
        one = printed(pattern)
        assert one.change.shape == (3, 3)
        assert 100 <= one.parameters.sh <= 250  # the range of table 1
        assert all(0.001 <= alpha <= 1.5 for alpha in one.parameters.alpha)
    assert [p for p in ALL if printed(p).impulse is not None] == [
        "AAB", "BAA", "BAB", "BBA", "BBB",
    ]  # fmt: skip


def test_digits_of_table_3_and_4_as_printed():
    given = printed("AAA").parameters
    assert (given.sh, given.sw, given.e) == (191.5, 0.487, 0.541)
    assert (given.mu_s, given.mu_d, given.alpha) == (0.007, 0.024, (1.3, 1.136))
    assert printed("AAA").change[0].tolist() == [0.006118, 0.004378, -0.056927]
    assert printed("BBB").impulse[2].tolist() == [0.000375, 0.000052, 0.063157]


def test_printed_impulses_sum_to_zero_by_construction():
    """P_ij = -P_ji, printed to 1e-6: three roundings."""
    for pattern in ALL:
        impulse = printed(pattern).impulse
        if impulse is not None:
            assert np.abs(impulse.sum(axis=0)).max() < 1.6e-6


def test_four_tables_violate_the_conservation_of_momentum():
    imbalance = {pattern: printed(pattern).imbalance for pattern in ALL}
    violating = [pattern for pattern, value in imbalance.items() if abs(value) > 0.05]
    assert violating == ["ABA", "ABB", "BAA", "BBA"]
    assert imbalance["ABB"] == pytest.approx(1.022, abs=5e-4)
    assert imbalance["BAA"] == pytest.approx(-0.494, abs=5e-4)


def test_six_tables_are_copies_of_the_first():
    for pattern in ALL:
        expected = {"AAA": (False,) * 3, "AAB": (False, True, False)}
        assert printed(pattern).copied == expected.get(pattern, (True,) * 3)


def test_printed_evaluation_values_cannot_be_those_of_the_printed_means():
    """The mean of lengths is not below the length of the mean: 17 times and more."""
    for pattern in ALL:
        values = printed(pattern).evaluations()
        if values is not None:
            lengths, components = values
            assert components > lengths > 15 * printed(pattern).evaluation
    # sum over x, y, z and balls of table 8
    assert printed("BAA").evaluations()[1] == pytest.approx(0.125078, abs=1e-9)


def test_the_drop_speed_is_that_of_the_measured_row():
    """Each ball of table 4 alone gives .47 to .50 m/s (Hertz, e = .95), but ball 2.

    Ball 2 hardly moves, so it says little.
    """
    speed = drop_speed()
    assert 0.47 < speed < 0.50
    assert 0.056927 / 0.115 / 1.0395 < speed < 0.054129 / 0.115 / 0.9493
