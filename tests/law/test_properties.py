"""What every impact must obey, whatever the masses, speeds, gaps and couplings.

All of it goes through the C interface of the library that simulations use. Speeds are
in units of the fastest closing speed, which is about 1 m/s.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from islands import (
    STIFFNESS,
    Island,
    integrate,
    island,
    logarithmic,
    networks,
    ring,
    row,
    rows,
    star,
    strikes,
)

from mujoco_impact import law, reference
from mujoco_impact.errors import LawError

# The examples are the same in every run: a failure is a change of the code.
examples = settings(max_examples=40, deadline=None, derandomize=True)

# An impact ends when no contact closes faster than 1e-6 of the fastest (kSpeedFloor);
# scaling the impulses to the energy afterwards moves speeds by as much again.
CLOSING = 1e-5

# Sums of up to 30 terms of rounding.
ROUNDING = 1e-13

losses = st.sampled_from(
    [
        (1.0, "bistiffness"),
        (0.9, "bistiffness"),
        (0.3, "bistiffness"),
        (0.0, "bistiffness"),
        (0.9, "viscous"),
        (0.3, "viscous"),
    ]
)


@examples
@given(st.one_of(rows(), networks()), losses)
def test_an_impact_is_passive_pushes_only_and_leaves_nothing_closing(of, loss):
    e, dissipation = loss
    solution = of.solve(restitution=e, dissipation=dissipation)
    before, after = of.energy(of.velocity), of.energy(of.after(solution.impulse))
    assert solution.impulse.max() > 0
    assert np.all(solution.impulse >= 0)
    assert after <= before * (1 + ROUNDING)
    closing = of.closing_speed - of.delassus @ solution.impulse
    assert closing.max() <= CLOSING * of.fastest


@examples
@given(st.one_of(rows(), networks()))
def test_an_elastic_impact_conserves_energy(of):
    solution = of.solve()
    assert solution.impulse.max() > 0
    after = of.energy(of.after(solution.impulse))
    assert after == pytest.approx(of.energy(of.velocity), rel=ROUNDING)


@examples
@given(rows(), losses)
def test_a_row_keeps_its_momentum_and_its_order(of, loss):
    e, dissipation = loss
    solution = of.solve(restitution=e, dissipation=dissipation)
    after = of.after(solution.impulse)
    scale = float(of.mass @ np.abs(of.velocity))
    assert abs(of.mass @ after - of.mass @ of.velocity) < ROUNDING * scale
    # left to right: no ball runs into the next one
    assert np.all(np.diff(after) >= -CLOSING * of.fastest)


@examples
@given(st.one_of(rows(), networks()), losses, st.booleans())
def test_the_closing_speeds_are_those_of_the_impulses(of, loss, passive):
    e, dissipation = loss
    solution = of.solve(restitution=e, dissipation=dissipation, passive=passive)
    expected = of.closing_speed - of.delassus @ solution.impulse
    assert solution.impulse.max() > 0
    scale = np.abs(of.delassus @ solution.impulse).max() + of.fastest
    assert np.abs(solution.closing_speed - expected).max() < ROUNDING * scale


@examples
@given(st.one_of(rows(), networks()), losses)
def test_forces_come_after_their_onset(of, loss):
    """M = ∫ t F dt of a push lies behind P t_onset."""
    e, dissipation = loss
    solution = of.solve(restitution=e, dissipation=dissipation)
    pushed = solution.impulse > 1e-6 * solution.impulse.max()
    assert pushed.any()
    late = solution.moment - solution.onset * solution.impulse
    assert np.all(late[pushed] > 0)


# --- symmetries: struck rows are not chaotic, so what rounding does to them stays
# --- small; it may change the choice of steps, so what is left is the error of those,
# --- 1e-6 a step.


def symmetric(actual, expected, tolerance: float = 5e-6) -> None:
    scale = np.abs(expected).max()
    assert scale > 0
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * scale)


@examples
@given(strikes(), losses)
def test_the_mirror_image_of_a_row_does_the_mirror_image(of, loss):
    e, dissipation = loss
    image = row(
        of.mass[::-1],
        -of.velocity[::-1],
        stiffness=of.stiffness[::-1],
        gap=of.gap[::-1],
    )
    options = {"restitution": e, "dissipation": dissipation}
    impulse = of.solve(**options).impulse
    mirrored = image.solve(**options).impulse[::-1]
    symmetric(mirrored, impulse)


@examples
@given(strikes(), losses, st.randoms(use_true_random=False))
def test_the_order_of_the_contacts_does_not_matter(of, loss, random):
    e, dissipation = loss
    order = list(range(len(of.gap)))
    random.shuffle(order)
    shuffled = island(
        of.mass,
        of.jacobian[order],
        of.velocity,
        stiffness=of.stiffness[order],
        gap=of.gap[order],
    )
    options = {"restitution": e, "dissipation": dissipation}
    impulse = of.solve(**options).impulse
    permuted = shuffled.solve(**options).impulse
    symmetric(permuted, impulse[order])


@examples
@given(strikes(), losses, logarithmic(1e-3, 1e3), st.sampled_from("vmK"))
def test_impulses_and_times_scale_with_speed_mass_and_stiffness(of, loss, s, what):
    """y ~ (m v^2/K)^(2/5), so gaps scale with it; P ~ m v; T ~ y/v; M ~ P T."""
    e, dissipation = loss
    v, m, K = (s if what == one else 1.0 for one in "vmK")
    length = (m * v**2 / K) ** 0.4
    scaled = Island(
        m * of.mass, of.jacobian, v * of.velocity, K * of.stiffness, length * of.gap
    )
    options = {"restitution": e, "dissipation": dissipation}
    one, other = of.solve(**options), scaled.solve(**options)
    symmetric(other.impulse, m * v * one.impulse)
    # a small push at the end weighs more in the moment, by the time that passed
    symmetric(other.moment, m * length * one.moment, tolerance=1e-3)


# --- limits


@examples
@given(strikes(), st.sampled_from(["bistiffness", "viscous"]))
def test_restitution_near_one_is_nearly_elastic(of, dissipation):
    elastic = of.solve().impulse
    nearly = of.solve(restitution=1 - 1e-5, dissipation=dissipation).impulse
    # the loss of each of a few contacts is of first order in 1 - e
    assert np.abs(nearly - elastic).max() < 1e-3 * elastic.max()


@examples
@given(strikes())
def test_restitution_near_zero_is_nearly_plastic(of):
    plastic = of.solve(restitution=0.0).impulse
    nearly = of.solve(restitution=0.01).impulse
    assert np.abs(nearly - plastic).max() < 0.02 * plastic.max()


@examples
@given(logarithmic(1e-6, 1e6), st.floats(0, 1))
def test_a_pair_of_any_mass_ratio_rebounds_with_e(ratio, e):
    pair = row([1.0, ratio], [1.0, -0.3])
    P = pair.solve(restitution=e).impulse[0]
    mu = ratio / (1 + ratio)
    assert pytest.approx((1 + e) * mu * 1.3, rel=1e-14) == P


@examples
@given(st.lists(logarithmic(1e-3, 1e3), min_size=3, max_size=3), losses)
def test_mass_ratios_up_to_a_million_end_well(masses, loss):
    e, dissipation = loss
    three = row(masses, [1.0, 0.0, 0.0])
    solution = three.solve(restitution=e, dissipation=dissipation)
    after = three.after(solution.impulse)
    assert np.all(np.diff(after) >= -CLOSING)
    assert three.energy(after) <= three.energy(three.velocity) * (1 + ROUNDING)


def test_a_ball_far_from_the_others_meets_them_one_by_one():
    """Gaps of many compressions: the sequence of isolated impacts."""
    apart = row([1, 3, 1], [1, 0, 0], gap=[0, 1e-2])
    v = apart.after(apart.solve().impulse)
    # 1 on 3 leaves -1/2 and 1/2; 3 on 1 leaves 1/4 and 3/4
    np.testing.assert_allclose(v, [-0.5, 0.25, 0.75], rtol=0, atol=1e-5)


def test_a_horizon_leaves_later_impacts_alone():
    later = row([1, 1, 1], [1, 0, 0], gap=[0, 1e-2])
    assert later.solve(horizon=5e-3).impulse[1] == 0
    assert later.solve(horizon=2e-2).impulse[1] == pytest.approx(1, rel=1e-5)


# --- against an integration that shares no code with the law

UNEQUAL = [0.115, 0.23, 0.115, 0.115, 0.3, 0.2, 0.115, 0.23, 0.23, 0.115, 0.15, 0.115]
LONG_ROWS = {
    "12 equal": ([0.115] * 12, [1.0] + [0.0] * 11, 0.0),
    "12 unequal": (UNEQUAL, [1.0] + [0.0] * 11, 0.0),
    "from both ends": ([0.115] * 12, [1.0] + [0.0] * 10 + [-0.7], 0.0),
    "both ends, unequal, gaps": (
        UNEQUAL,
        [1.0] + [0.0] * 10 + [-0.7],
        [0, 2e-6, 0, 0, 1e-5, 0, 0, 5e-6, 0, 0, 0],
    ),
    "three come in": ([0.115] * 12, [1.0] * 3 + [0.0] * 9, 0.0),
}


@pytest.mark.parametrize("case", LONG_ROWS)
def test_long_rows_are_what_scipy_makes_of_them(case):
    masses, velocities, gap = LONG_ROWS[case]
    of = row(masses, velocities, gap=gap)
    truth = integrate(of)
    ours = of.after(of.solve().impulse)
    # the integrator keeps its error to 1e-6 a step; what remains of it is smaller
    assert np.abs(ours - truth).max() < 2e-6


@pytest.mark.parametrize("gap", [0.0, 3e-6])
def test_long_viscous_rows_are_what_the_reference_makes_of_them(gap):
    radii = [0.015] * 12
    truth = reference.first_impact(
        UNEQUAL,
        radii,
        gap=gap,
        restitution=0.9,
        dissipation="hunt-crossley",
        rtol=1e-10,
    )
    K = reference.hertz_stiffness(0.015, 0.015, 2e11, 0.3)
    of = row(UNEQUAL, [1.0] + [0.0] * 11, stiffness=K, gap=gap)
    solution = of.solve(restitution=0.9, dissipation="viscous")
    # the force of a viscous contact jumps as it closes, which costs a digit
    assert np.abs(of.after(solution.impulse) - truth.velocities).max() < 5e-5


@pytest.mark.parametrize(
    ("masses", "e"), [([1.0] * 6, 0.9), ([1.0] * 6, 0.6), (UNEQUAL, 0.9)]
)
def test_bistiffness_rows_are_what_scipy_makes_of_them(masses, e):
    of = row(masses, [1.0] + [0.0] * (len(masses) - 1))
    truth = integrate(of, restitution=e)
    ours = of.after(of.solve(restitution=e).impulse)
    # where contacts close again, errors of the gaps they left grow by a factor of ten
    assert np.abs(ours - truth).max() < 1e-5


NETWORKS = {
    "star": island([1, 0.5, 2, 1], star(3), [0, 1, -0.5, 0]),
    "triangle": island([1, 1, 2, 2, 1, 1], ring(3), [0, 1, 0.5, -0.2, 0, 0]),
    "hexagon": island([1] * 12, ring(6), [-1, 0] + [0] * 10),
}


@pytest.mark.parametrize("name", NETWORKS)
def test_stars_and_rings_are_what_scipy_makes_of_them(name):
    of = NETWORKS[name]
    ours = of.after(of.solve().impulse)
    assert np.abs(ours - integrate(of)).max() < 2e-6


# --- the guard


@examples
@given(networks(), st.floats(0.1, 10))
def test_the_guard_stops_exactly_where_energy_would_grow(of, size):
    P = size * np.abs(np.sin(np.arange(1, len(of.gap) + 1)))
    c, W = of.closing_speed, of.delassus
    scale = law.passive_scale(W, c, P)
    assert 0 <= scale <= 1
    gain = -c @ P + P @ W @ P / 2
    scaled = -c @ (scale * P) + scale**2 * (P @ W @ P) / 2
    work = abs(c @ P) + P @ W @ P
    assert scaled <= ROUNDING * work
    if gain <= 0:
        assert scale == 1
    else:
        assert scale < 1
        assert abs(scaled) <= ROUNDING * work


def test_the_guard_of_one_contact_is_the_elastic_impulse():
    assert law.passive_scale([[2.0]], [1.0], [4.0]) == 0.25
    assert law.passive_scale([[2.0]], [1.0], [0.5]) == 1
    assert law.passive_scale([[2.0]], [-1.0], [0.5]) == 0


# --- refusals

GOOD = {"delassus": [[2.0, -1.0], [-1.0, 2.0]], "closing_speed": [1.0, 0.0]}
GOOD |= {"stiffness": STIFFNESS}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"delassus": [[2.0]]}, r"delassus has shape \(1, 1\), allowed: \(2, 2\)"),
        ({"delassus": [[2.0, 1.0], [-1.0, 2.0]]}, "symmetric"),
        ({"delassus": [[0.0, -1.0], [-1.0, 2.0]]}, "positive diagonal"),
        ({"closing_speed": [np.nan, 0.0]}, "closing_speed = .*finite"),
        ({"stiffness": 0.0}, r"stiffness = .*> 0 \[N/m\^1.5\]"),
        ({"stiffness": [1e10, np.inf]}, "stiffness = .*finite"),
        ({"gap": -1e-6}, "gap = .*>= 0"),
        ({"restitution": 1.01}, r"restitution = 1.01; allowed: \[0.0, 1\]"),
        (
            {"restitution": 0.0, "dissipation": "viscous"},
            r"restitution = 0.0; allowed: \[0.05, 1\]",
        ),
        ({"dissipation": "none"}, "dissipation = 'none'; allowed: .*'bistiffness'"),
        ({"tolerance": 0.1}, r"tolerance = 0.1; allowed"),
    ],
)
def test_bad_arguments_are_named_with_what_is_allowed(change, text):
    with pytest.raises(LawError, match=text):
        law.solve_impact(**(GOOD | change))


def test_an_impact_that_cannot_end_says_so():
    """Beads on a closed track without room never part."""
    W = [[2.0, -1.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]]
    with pytest.raises(LawError, match=r"of 3 contacts did not end within \d+ steps"):
        law.solve_impact(W, [1.0, -0.5, -0.5], STIFFNESS)
