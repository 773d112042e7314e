"""Geometry, stiffness and energy of a row of Hertz balls."""

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest
from scipy.integrate import quad

import cradle_models as cm
from mujoco_impact import reference
from mujoco_impact.errors import ImpactError

RNG_SEED = 20061


def test_the_stiffness_of_two_30_mm_steel_balls() -> None:
    # E = 200 GPa, nu = 0.3: E* = 109.89 GPa, R* = 7.5 mm, 4/3 E* sqrt(R*).
    stiffness = reference.hertz_stiffness(0.015, 0.015, 2e11, 0.3)
    assert pytest.approx(1.26889e10, rel=1e-5) == stiffness


def test_contact_time_is_that_of_the_energy_integral() -> None:
    mass, stiffness, speed = 0.0575, 1.2689e10, 0.7
    deepest = (5 * mass * speed**2 / (4 * stiffness)) ** 0.4
    # x = 1 - s^2 takes the square root singularity out of 1 / sqrt(1 - x^2.5).
    half, _ = quad(
        lambda s: 2 * s / math.sqrt(1 - (1 - s * s) ** 2.5), 0, 1, epsabs=1e-12
    )
    time = reference.contact_time(mass, stiffness, speed)
    assert pytest.approx(2 * half * deepest / speed, rel=1e-9) == time
    # The usual form with its constant rounded to six digits.
    usual = 2.94328 * (5 * mass / (4 * stiffness)) ** 0.4 * speed**-0.2
    assert pytest.approx(usual, rel=2e-6) == time
    found = reference.largest_compression(mass, stiffness, speed)
    assert pytest.approx(deepest, rel=1e-14) == found


def test_the_gap_is_the_distance_between_the_spheres() -> None:
    chain = reference.Chain.of(cm.balls("ABBA"), gap=(0.0, 1e-4, -2e-5))
    angles = np.random.default_rng(RNG_SEED).uniform(-1.5, 1.5, (20, 4))
    pivots = np.concatenate(([0.0], np.cumsum(chain.spacing)))
    x = pivots + 0.3 * np.sin(angles)
    z = -0.3 * np.cos(angles)
    distance = np.hypot(np.diff(x), np.diff(z))
    expected = distance - np.add(chain.radii[:-1], chain.radii[1:])
    np.testing.assert_allclose(chain.separation(angles), expected, atol=1e-15)


def test_compressions_of_a_nanometre_keep_nine_digits() -> None:
    chain = reference.Chain.of(cm.balls("AA"))
    # At the bottom, ball 1 ahead by the angle a: x moves by L sin a, the height by a^2.
    angle = 1e-9 / 0.3
    gap = chain.separation([angle, 0.0])[0]
    assert pytest.approx(-1e-9, rel=1e-9) == gap


def test_gap_derivatives_agree_with_differences() -> None:
    chain = reference.Chain.of(cm.balls("ABA"), gap=1e-4)
    rng = np.random.default_rng(RNG_SEED)
    angles = rng.uniform(-0.5, 0.5, 3)
    _, left, right = chain.contacts(angles)
    step = 1e-6
    for i in range(3):
        shift = step * (np.arange(3) == i)
        slope = chain.separation(angles + shift) - chain.separation(angles - shift)
        expected = np.zeros(2)
        if i < 2:
            expected[i] = left[i]
        if i > 0:
            expected[i - 1] = right[i - 1]
        # Central differences: rounding 1e-16 / 1e-6, truncation 1e-12.
        np.testing.assert_allclose(slope / (2 * step), expected, atol=1e-9)


def test_energy_is_that_of_masses_on_arms_and_of_hertz_springs() -> None:
    chain = reference.Chain.of(cm.balls("AB"))
    assert chain.energy([0.0, 0.0], [0.0, 0.0]) == 0
    assert pytest.approx(0.115 * 9.81 * 0.3 * (1 - math.cos(0.4))) == chain.energy(
        [-0.4, 0.0], [0.0, 0.0]
    )
    inertia = 0.230 * 0.3**2 + 0.4 * 0.230 * 0.01905**2
    assert pytest.approx(inertia * 2.0) == chain.energy([0.0, 0.0], [0.0, 2.0])
    angles = [1e-5, -1e-5]
    deep = -chain.separation(angles)[0]
    stored = float(
        chain.energy(angles, [0, 0]) - chain.mechanical_energy(angles, [0, 0])
    )
    work, _ = quad(lambda y: chain.stiffness[0] * y**1.5, 0, deep, epsabs=0)
    assert deep > 5e-6
    assert pytest.approx(work, rel=1e-9) == stored


def test_releasing_lifts_to_the_left_as_the_models_do() -> None:
    chain = reference.Chain.of(cm.balls("AAA"))
    angles, velocities = reference.release_state(chain, 30.0, 2)
    np.testing.assert_allclose(angles, [-math.pi / 6, -math.pi / 6, 0])
    assert not velocities.any()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: reference.Chain.of(cm.balls("AA"), gap=[0.0, 0.0]), ("1 gaps", "2")),
        (lambda: reference.Chain((1.0,), (-0.1,), ()), ("radii", "-0.1", "> 0")),
        (lambda: reference.Chain.of(cm.balls("AA"), poisson=0.6), ("0.6", "0.5")),
        (lambda: reference.Chain.of(cm.balls("AA"), gap=math.inf), ("inf",)),
        (lambda: reference.pendulum_row(cm.balls("AA"), release=200), ("200", "180")),
        (lambda: reference.pendulum_row(cm.balls("AA"), released=3), ("3", "0 to 2")),
        (lambda: reference.pendulum_row(cm.balls("AA"), duration=0), ("duration",)),
        (lambda: reference.pendulum_row(cm.balls("AA"), rtol=0.1), ("rtol", "0.1")),
        (lambda: reference.first_impact([1], [1]), ("1 masses", "2 or more")),
        (lambda: reference.first_impact([1, 1], [1, -1]), ("above 0",)),
        (
            lambda: reference.first_impact([1, 1], [1, 1], gap=-1e-6),
            ("-1e-06", "at least 0"),
        ),
        (
            lambda: reference.first_impact([1, 1, 1], [1, 1, 1], gap=[0, 0, 0]),
            ("[0, 0, 0]", "or 2"),
        ),
        (
            lambda: reference.first_impact([1, 1], [1, 1], n_incoming=2),
            ("n_incoming", "2"),
        ),
        (
            lambda: reference.first_impact([1, 1], [1, 1], restitution=1.1),
            ("1.1", "1"),
        ),
        (
            lambda: reference.first_impact([1, 1], [1, 1], restitution=0.9),
            ("0.9", "'bistiffness'"),
        ),
        (
            lambda: reference.first_impact(
                [1, 1], [1, 1], dissipation=cast(Any, "tar")
            ),
            ("'tar'", "'bistiffness'"),
        ),
    ],
)
def test_bad_values_are_named_with_what_is_allowed(
    make: Callable[[], object], words: tuple[str, ...]
) -> None:
    with pytest.raises(ImpactError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)
