"""What every impact with friction must obey, whatever the bodies and how they touch.

Speeds are in units of the fastest relative one, which is about 1 m/s.
"""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from spatial import (
    STIFFNESS,
    Body,
    Island,
    Touch,
    ball,
    box_on_ground,
    island,
    touching_balls,
)

# The examples are the same in every run: a failure is a change of the code.
examples = settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    # a busy machine is no failure
    suppress_health_check=[HealthCheck.too_slow],
)

# Sums of up to 30 terms of rounding.
ROUNDING = 1e-12

# An impact ends when no contact closes faster than 1e-6 of the fastest (kSpeedFloor);
# scaling the impulses to the energy afterwards moves speeds by as much again.
CLOSING = 1e-5

unit = st.floats(-1, 1, allow_nan=False, width=32)
vector = st.tuples(unit, unit, unit).map(np.array)
frictions = st.sampled_from((0.05, 0.2, 0.5, 1.0, 3.0))
losses = st.sampled_from(
    [
        (1.0, "bistiffness"),
        (0.9, "bistiffness"),
        (0.3, "bistiffness"),
        (0.0, "bistiffness"),
        (0.8, "viscous"),
    ]
)


@st.composite
def boxes(draw) -> Island:
    """A box that falls on a corner, an edge or a face."""
    quaternion = draw(
        st.sampled_from(
            [(1, 0, 0, 0), (1, 0.4, 0, 0), (1, 0, -0.7, 0), (1, 0.3, 0.5, -0.2)]
        )
    )
    velocity = draw(vector)
    velocity[2] = -1.0
    return box_on_ground((0.05, 0.07, 0.04), quaternion, velocity, 5 * draw(vector))


@st.composite
def heaps(draw) -> Island:
    """Balls of unequal mass that touch one another in space, and maybe the ground."""
    radius = 0.03
    bodies = [ball(1, radius, [0, 0, radius], draw(vector), 30 * draw(vector))]
    for _ in range(draw(st.integers(1, 4))):
        way = draw(vector) + np.array([0, 0, 1.2])  # upwards: none is in the ground
        place = bodies[-1].position + 2 * radius * way / np.linalg.norm(way)
        mass = draw(st.sampled_from((0.3, 1.0, 2.0)))
        bodies.append(ball(mass, radius, place, draw(vector), 30 * draw(vector)))
    touches = touching_balls(radius, bodies)
    if draw(st.booleans()):
        touches.append(Touch(-1, 0, np.zeros(3), np.array([0, 0, 1.0])))
    # the first contact closes with 1 m/s
    normal = touches[0].normal
    closing = normal @ (bodies[1].velocity - bodies[0].velocity)
    bodies[1] = ball(
        bodies[1].mass,
        radius,
        bodies[1].position,
        bodies[1].velocity - (closing + 1) * normal,
        bodies[1].spin,
    )
    return island(bodies, touches)


islands = st.one_of(boxes(), heaps())


@examples
@given(islands, frictions, losses)
def test_friction_only_loses_energy_and_stays_in_its_cone(of, mu, loss):
    e, dissipation = loss
    solution = of.solve(mu, restitution=e, dissipation=dissipation)
    before, after = of.energy(of.motion), of.energy(of.after(solution.impulse))
    assert solution.impulse[:, 0].max() > 0
    assert after <= before * (1 + ROUNDING)
    normal, tangential = solution.impulse[:, 0], solution.impulse[:, 1:]
    assert np.all(normal >= 0)
    cone = mu * normal * (1 + ROUNDING) + ROUNDING * normal.max()
    assert np.all(np.linalg.norm(tangential, axis=1) <= cone)


@pytest.mark.parametrize("masses", [(1, 2, 0.3), (1, 1, 1, 1), (2, 0.3, 1, 0.3)])
def test_an_elastic_row_that_nothing_spins_gains_no_energy(masses):
    """Friction takes nothing here: without the guard, 3e-7 of the energy is gained."""
    radius = 0.03
    bodies = [
        ball(mass, radius, [2 * radius * i, 0, 0], [float(i == 0), 0, 0])
        for i, mass in enumerate(masses)
    ]
    row = island(bodies, touching_balls(radius, bodies))
    for tolerance in (1e-4, 1e-5, 1e-6):
        solution = row.solve(0.3, restitution=1.0, tolerance=tolerance)
        gain = row.energy(row.after(solution.impulse)) / row.energy(row.motion) - 1
        assert -tolerance < gain < ROUNDING


@examples
@given(islands, frictions, losses)
def test_nothing_closes_after_an_impact(of, mu, loss):
    e, dissipation = loss
    solution = of.solve(mu, restitution=e, dissipation=dissipation)
    assert solution.impulse[:, 0].max() > 0
    assert solution.velocity[:, 0].min() >= -CLOSING * of.fastest


@examples
@given(islands, frictions, losses)
def test_the_velocities_are_those_of_the_impulses(of, mu, loss):
    e, dissipation = loss
    solution = of.solve(mu, restitution=e, dissipation=dissipation)
    expected = of.velocity.ravel() + of.delassus @ solution.impulse.ravel()
    assert solution.impulse[:, 0].max() > 0
    np.testing.assert_allclose(
        solution.velocity.ravel(), expected, rtol=0, atol=ROUNDING * of.fastest * 10
    )


@examples
@given(islands, frictions, losses)
def test_forces_come_after_their_onset(of, mu, loss):
    """M = ∫ t F dt of a push lies behind P t_onset, and that of friction with it."""
    e, dissipation = loss
    solution = of.solve(mu, restitution=e, dissipation=dissipation)
    P, M = solution.impulse[:, 0], solution.moment[:, 0]
    pushed = 1e-6 * P.max() < P
    assert pushed.any()
    late = M - solution.onset * P
    assert np.all(late[pushed] > 0)
    # |∫ (t - onset) F_t dt| <= mu ∫ (t - onset) F dt
    friction = (
        solution.moment[:, 1:] - solution.onset[:, None] * solution.impulse[:, 1:]
    )
    size = np.linalg.norm(friction, axis=1)
    assert np.all(size[pushed] <= mu * late[pushed] * (1 + 1e-6))


@examples
@given(islands, losses)
def test_friction_that_vanishes_is_none(of, loss):
    e, dissipation = loss
    without = of.solve(0.0, restitution=e, dissipation=dissipation)
    little = of.solve(1e-7, restitution=e, dissipation=dissipation)
    np.testing.assert_allclose(
        of.after(little.impulse)[:, :3],
        of.after(without.impulse)[:, :3],
        rtol=0,
        # steps are chosen otherwise: the error of the law without friction
        atol=1e-4 * of.fastest,
    )


def motion(of: Island, mu, e: float) -> np.ndarray:
    """Velocities of the centres after the impact, in units of the fastest."""
    solution = of.solve(mu, restitution=e, tolerance=1e-7)
    return of.after(solution.impulse)[:, :3] / of.fastest


def with_rows(of: Island, rows: np.ndarray) -> Island:
    return Island(of.bodies, rows, of.inverse_inertia, of.motion)


# Rotations, orders and rounding change the choice of steps. Friction is solved to ten
# times the tolerance a step, 1e-6 here, for up to some hundred steps.
SAME = 2e-4

elastic_or_not = st.sampled_from((1.0, 0.7))


@examples
@given(heaps(), frictions, elastic_or_not, st.floats(0, 6))
def test_tangents_may_be_turned(of, mu, e, turn):
    n = len(of.velocity)
    axes = np.zeros((3 * n, 3 * n))
    for k in range(n):
        c, s = np.cos(turn + k), np.sin(turn + k)
        axes[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = [[1, 0, 0], [0, c, s], [0, -s, c]]
    turned = motion(with_rows(of, axes @ of.jacobian), mu, e)
    np.testing.assert_allclose(turned, motion(of, mu, e), rtol=0, atol=SAME)


@examples
@given(heaps(), frictions, elastic_or_not, st.randoms(use_true_random=False))
def test_the_order_of_the_contacts_does_not_matter(of, mu, e, random):
    order = list(range(len(of.velocity)))
    random.shuffle(order)
    rows = of.jacobian.reshape(len(order), 3, -1)[order].reshape(of.jacobian.shape)
    shuffled = motion(with_rows(of, rows), mu, e)
    np.testing.assert_allclose(shuffled, motion(of, mu, e), rtol=0, atol=SAME)


@examples
@given(heaps(), frictions, elastic_or_not)
def test_the_mirror_image_does_the_mirror_image(of, mu, e):
    mirror = np.array([1, -1, 1])
    bodies = [
        Body(
            body.mass,
            body.inertia,
            mirror * body.position,
            mirror * body.velocity,
            -mirror * body.spin,
        )
        for body in of.bodies
    ]
    radius = of.bodies[0].position[2]
    touches = touching_balls(radius, bodies)
    if len(touches) < len(of.velocity):
        touches.append(Touch(-1, 0, np.zeros(3), np.array([0, 0, 1.0])))
    image = motion(island(bodies, touches), mu, e)
    np.testing.assert_allclose(image, mirror * motion(of, mu, e), rtol=0, atol=SAME)


@examples
@given(boxes(), frictions, elastic_or_not, st.sampled_from((1e-2, 1e2)))
def test_velocities_do_not_depend_on_the_stiffness(of, mu, e, factor):
    options = {"restitution": e, "tolerance": 1e-7}
    soft = of.solve(mu, stiffness=STIFFNESS * factor, **options)
    stiff = of.solve(mu, **options)
    np.testing.assert_allclose(
        of.after(soft.impulse)[:, :3],
        of.after(stiff.impulse)[:, :3],
        rtol=0,
        atol=SAME * of.fastest,
    )
    # time goes as K^(-2/5)
    ratio = soft.moment[0, 0] / stiff.moment[0, 0]
    assert ratio == pytest.approx(factor**-0.4, rel=1e-2)
