"""Coulomb friction in impacts: closed forms and what any impact must obey."""

import numpy as np
import pytest

from mujoco_impact import law
from mujoco_impact.errors import LawError

# A ball of mass 1 and radius 1 on the ground: 2/5 m R^2 resists its spin.
BALL = np.diag([1.0, 3.5, 3.5])


@pytest.mark.parametrize(
    ("slip", "expected"), [(0.3, -0.3 / 3.5), (3.0, -0.3 * 1.8), (-3.0, 0.3 * 1.8)]
)
def test_a_ball_sticks_or_slides(slip, expected):
    """Coulomb's law in closed form: P_t = -v/w, or mu P_n against the slip."""
    solution = law.solve_impact_with_friction(
        BALL, [[-1.0, slip, 0.0]], 1e9, 0.3, restitution=0.8
    )
    # the tolerance of the law
    np.testing.assert_allclose(
        solution.impulse, [[1.8, expected, 0.0]], rtol=0, atol=1e-6
    )


@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("velocity", [[-1, 0.5, 0.2], [-1, 3, 1], [-1, 0.1, 0]])
def test_one_contact_by_its_impulse_is_what_the_integration_makes_of_it(
    velocity, restitution
):
    """A second contact that never presses makes the law integrate in time."""
    J = np.array([[2, -1, 0, 1], [1, 2, 0.5, 0], [-1, 0.3, 2, 1]])
    both = np.eye(6)
    both[:3, :3] = J @ J.T
    options = {"restitution": restitution, "tolerance": 1e-8}
    alone = law.solve_impact_with_friction(
        both[:3, :3], [velocity], 1e9, 0.3, **options
    )
    beside = law.solve_impact_with_friction(
        both, [velocity, [0, 0, 0]], 1e9, 0.3, gap=[0, 1], **options
    )
    size = np.abs(alone.impulse).max()
    # each is right to some tolerances of a step
    np.testing.assert_allclose(alone.impulse[0], beside.impulse[0], atol=3e-6 * size)
    size = np.abs(alone.moment).max()
    # and time, a quadrature, to 1e-5
    np.testing.assert_allclose(alone.moment[0], beside.moment[0], atol=3e-5 * size)


GOOD = {"delassus": BALL, "velocity": [[-1.0, 0.3, 0.0]], "stiffness": 1e9, "mu": 0.3}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"delassus": np.eye(2)}, r"delassus has shape \(2, 2\), allowed: \(3, 3\)"),
        ({"delassus": np.triu(np.ones((3, 3)))}, "symmetric"),
        ({"delassus": np.diag([0.0, 1.0, 1.0])}, "positive diagonal"),
        ({"velocity": [-1.0, 0.3, 0.0]}, r"velocity has shape \(3,\), allowed"),
        ({"velocity": [[np.nan, 0.3, 0.0]]}, "velocity = .*finite"),
        ({"mu": -0.1}, "mu = .*allowed: finite numbers >= 0"),
        ({"mu": np.inf}, "mu = .*allowed: finite numbers >= 0"),
        ({"stiffness": 0.0}, "stiffness = "),
        ({"gap": -1.0}, "gap = "),
        ({"restitution": 1.1}, "restitution = 1.1; allowed"),
    ],
)
def test_bad_arguments_are_named_with_what_is_allowed(change, text):
    with pytest.raises(LawError, match=text):
        law.solve_impact_with_friction(**(GOOD | change))
