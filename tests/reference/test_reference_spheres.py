"""Spheres in space: the Hertz problem against what is known of it."""

import math

import numpy as np
import pytest

from mujoco_impact.reference import ChainError, contact_time, first_impact, spheres
from mujoco_impact.reference.spheres import Plane, Sphere, sphere_velocities

STILL = np.zeros(3)
RADIUS, MASS = 0.015, 0.11


def sphere(x, v=(0, 0, 0), *, mass=MASS, radius=RADIUS, free=STILL, directions=None):
    """A sphere that can move anywhere unless told otherwise."""
    directions = np.eye(3) if directions is None else np.array(directions, dtype=float)
    position, velocity = np.array(x, dtype=float), np.array(v, dtype=float)
    return Sphere(mass, radius, position, velocity, np.array(free), directions)


def test_a_row_is_that_of_the_reference_on_a_line():
    """Touching balls of three masses; two integrations to 1e-11 and better."""
    masses = [0.11, 0.2, 0.11]
    row = [
        sphere(
            (2 * RADIUS * i - (1e-3 if i == 0 else 0), 0, 0),
            (1.0 if i == 0 else 0, 0, 0),
            mass=mass,
        )
        for i, mass in enumerate(masses)
    ]
    left = sphere_velocities(row, [], 0.004)
    known = first_impact(masses, [RADIUS] * 3).velocities
    np.testing.assert_allclose(left[:, 0], known, atol=1e-7)
    np.testing.assert_allclose(left[:, 1:], 0.0, atol=1e-12)


def test_two_spheres_part_along_the_line_of_centres():
    """Oblique, elastic, equal: the normal velocities are exchanged."""
    side = 0.5 * RADIUS
    row = [sphere((-0.1, side, 0), (1, 0, 0)), sphere((0, 0, 0))]
    left = sphere_velocities(row, [], 0.2)
    normal = np.array([math.sqrt(1 - 1 / 16), -1 / 4, 0.0])
    # the line turns by v t / 2 r while they touch, 1e-3
    np.testing.assert_allclose(left[1], normal[0] * normal, atol=3e-3)
    np.testing.assert_allclose(left.sum(axis=0), [1, 0, 0], atol=1e-9)
    energy = np.sum(left**2)
    assert energy == pytest.approx(1.0, abs=1e-9)


def test_a_fall_on_a_plane_comes_back_after_the_contact_time():
    """As fast as it came, and later by what the contact lasts."""
    gravity = (0, 0, -9.81)
    ball = sphere((0, 0, 0.1 + RADIUS), free=gravity)
    plane = Plane(STILL, np.array([0.0, 0.0, 1.0]))
    fall = math.sqrt(2 * 0.1 / 9.81)
    speed = 9.81 * fall
    modulus = 2e11 / (2 * (1 - 0.3**2))
    lasts = contact_time(MASS, 4 / 3 * modulus * math.sqrt(RADIUS), speed)
    time = fall + 0.01
    (left,) = sphere_velocities([ball], [plane], time)
    # gravity during the contact changes how long it lasts by 1e-4 of it
    assert left[2] == pytest.approx(speed - 9.81 * (0.01 - lasts), abs=1e-6)


def test_a_sphere_on_a_slide_goes_along_it_only():
    """An oblique blow on a ball that can move along x."""
    row = [
        sphere((0, -0.1, 0), (0.3, 1, 0)),
        sphere((0.035, 0, 0), directions=[[1, 0, 0]]),
    ]
    left = sphere_velocities(row, [], 0.3)
    assert left[1, 0] > 0.1
    assert left[1, 1:].tolist() == [0.0, 0.0]
    assert np.sum(left**2) == pytest.approx(1.09, abs=1e-8)


def test_what_never_meets_flies_on_and_what_stays_is_refused(monkeypatch):
    """A miss changes nothing; a ball that is pressed on a plane does not part."""
    miss = [sphere((-0.1, 0.1, 0), (1, 0, 0)), sphere((0, 0, 0))]
    assert sphere_velocities(miss, [], 0.3).tolist() == [[1, 0, 0], [0, 0, 0]]
    pressed = sphere((0, 0, RADIUS), (0, 0, -1e-6), free=(0, 0, -9.81))
    plane = Plane(STILL, np.array([0.0, 0.0, 1.0]))
    monkeypatch.setattr(spheres, "MOST_CONTACTS", 3)
    with pytest.raises(ChainError, match="stay together: 3 contacts"):
        sphere_velocities([pressed], [plane], 10.0)
