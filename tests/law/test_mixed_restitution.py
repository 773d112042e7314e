"""Contacts of one impact with a restitution each."""

import numpy as np
import pytest
from islands import integrate, island, ring, row

from mujoco_impact import law
from mujoco_impact.errors import LawError


@pytest.mark.parametrize("e", [(0.9, 0.4), (0.4, 0.9), (1.0, 0.7), (0.7, 1.0)])
@pytest.mark.parametrize("ratio", [1.0, 0.2])
def test_a_row_is_what_its_equations_integrate_to(e, ratio):
    of = row([1, 1, 2], [1, 0, 0], stiffness=[1.2e10, 1.2e10 * ratio])
    truth = integrate(of, restitution=np.array(e))
    after = of.after(of.solve(restitution=e, tolerance=1e-7).impulse)
    # the law ends at 1e-6 of the speed
    np.testing.assert_allclose(after, truth, atol=2e-6)


def test_a_ring_with_mixed_losses_is_what_its_equations_integrate_to():
    discs = np.zeros(8)
    discs[0] = 1.0
    of = island(np.ones(8), ring(4), discs)
    e = np.array([0.9, 0.5, 1.0, 0.7])
    truth = integrate(of, restitution=e)
    after = of.after(of.solve(restitution=e, tolerance=1e-7).impulse)
    np.testing.assert_allclose(after, truth, atol=2e-6)


@pytest.mark.parametrize("dissipation", ["bistiffness", "viscous"])
def test_contacts_that_close_one_after_the_other_have_their_own(dissipation):
    """With a gap between, the balls meet in pairs: u' = u - (1 + e) u / 2."""
    of = row([1, 1, 1], [1, 0, 0], gap=[0, 1e-3])
    one, other = 0.9, 0.4
    solution = of.solve(
        restitution=[one, other], dissipation=dissipation, tolerance=1e-8
    )
    second = (1 + one) / 2
    if dissipation == "viscous":
        # it refers to the fastest closing of the impact, so a slower one loses less
        assert of.after(solution.impulse)[2] > (1 + other) / 2 * second
        return
    expected = [1 - second, second * (1 - other) / 2, second * (1 + other) / 2]
    # 1e-7: the integration of two contacts
    np.testing.assert_allclose(of.after(solution.impulse), expected, atol=1e-7)


@pytest.mark.parametrize("dissipation", ["bistiffness", "viscous"])
def test_the_order_of_the_contacts_does_not_matter(dissipation):
    e = np.array([0.9, 0.5, 0.7])
    of = row([1, 2, 1, 3], [1, 0, 0, 0])
    mirror = row([3, 1, 2, 1], [0, 0, 0, -1])
    P = of.solve(restitution=e, dissipation=dissipation).impulse
    Q = mirror.solve(restitution=e[::-1], dissipation=dissipation).impulse
    # rounding of sums in another order
    np.testing.assert_allclose(P, Q[::-1], rtol=1e-10)


def test_equal_restitutions_are_one_to_the_bit():
    of = row([1, 2, 1, 3], [1, 0, 0, 0])
    for dissipation in ("bistiffness", "viscous"):
        one = of.solve(restitution=0.8, dissipation=dissipation)
        each = of.solve(restitution=[0.8] * 3, dissipation=dissipation)
        np.testing.assert_array_equal(one.impulse, each.impulse)


def test_with_friction_each_contact_has_its_own():
    """Two balls far apart on a table, in one problem: each leaves with its e."""
    W = np.diag([1.0, 3.5, 3.5] * 2)
    velocity = np.array([[-1.0, 0.2, 0.0], [-2.0, 0.0, 0.3]])
    solution = law.solve_impact_with_friction(
        W, velocity, 1e10, 0.1, restitution=[0.9, 0.5], tolerance=1e-8
    )
    # 1e-6: where the law ends
    np.testing.assert_allclose(solution.velocity[:, 0], [0.9, 1.0], atol=1e-6)


def test_a_restitution_out_of_range_is_refused():
    of = row([1, 1, 1], [1, 0, 0])
    with pytest.raises(LawError, match=r"restitution = \[0.9 1.1\]; allowed: \[0.0"):
        of.solve(restitution=[0.9, 1.1])
