"""Rows on hinges: balls, places, inertia, release."""

from collections.abc import Callable
from typing import Any, cast

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

import cradle_models as cm

CRADLES = [
    name
    for name in cm.list_models()
    if name.startswith(("row", "paper", "two", "force"))
]

# Positions are sums of a few decimals of at most a metre: some roundings of 1e-16 m.
TOUCHING = 1e-12


def at_rest(xml: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def gaps(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    distance = np.linalg.norm(np.diff(data.geom_xpos, axis=0), axis=1)
    radius = np.array(model.geom_size[:, 0])
    return np.asarray(distance - radius[:-1] - radius[1:])


def test_balls_a_and_b_are_those_of_dondo_and_noborio() -> None:
    # Section 4.1: A 30.0 mm and 115 g, B 38.1 mm and 230 g.
    assert pytest.approx((0.115, 0.030)) == (cm.A.mass, 2 * cm.A.radius)
    assert pytest.approx((0.230, 0.0381)) == (cm.B.mass, 2 * cm.B.radius)


@pytest.mark.parametrize("name", CRADLES)
def test_neighbours_touch_at_rest(name: str) -> None:
    model, data = at_rest(cm.make_model(name))
    np.testing.assert_allclose(gaps(model, data), 0, atol=TOUCHING)
    assert np.ptp(data.geom_xpos[:, 2]) == 0


def test_gaps_are_those_asked_for() -> None:
    model, data = at_rest(cm.row("ABBAA", gap=(1e-4, 0.0, -1e-6, 2e-3)))
    np.testing.assert_allclose(
        gaps(model, data), np.array((1e-4, 0.0, -1e-6, 2e-3)), atol=TOUCHING
    )


@pytest.mark.parametrize("pattern", cm.PAPER_PATTERNS)
def test_the_paper_models_hold_the_balls_of_their_pattern(pattern: str) -> None:
    model, _ = at_rest(cm.model_path(f"paper_{pattern.lower()}").read_text("utf-8"))
    masses = [{"A": 0.115, "B": 0.230}[letter] for letter in pattern]
    radii = [{"A": 0.015, "B": 0.01905}[letter] for letter in pattern]
    np.testing.assert_allclose(model.body_mass[1:], masses, rtol=1e-15)
    np.testing.assert_allclose(model.geom_size[:, 0], radii, rtol=1e-15)


def test_the_inertia_is_that_of_a_sphere_on_a_massless_arm() -> None:
    length = 0.27
    model, data = at_rest(cm.row("ABAB", length=length))
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    mass = np.array([0.115, 0.230, 0.115, 0.230])
    radius = np.array([0.015, 0.01905, 0.015, 0.01905])
    expected = mass * length**2 + 0.4 * mass * radius**2
    # A handful of roundings in MuJoCo's parallel axes.
    np.testing.assert_allclose(inertia, np.diag(expected), rtol=1e-13, atol=1e-18)


def test_a_positive_angle_moves_a_ball_along_the_row() -> None:
    model, data = at_rest(cm.row("AAA"))
    before = data.geom_xpos.copy()
    data.qpos[1], data.qvel[1] = 0.1, 2.0
    mujoco.mj_forward(model, data)
    moved = data.geom_xpos - before
    np.testing.assert_allclose(moved[1, 0], 0.3 * np.sin(0.1), rtol=1e-12)
    np.testing.assert_allclose(moved[1, 1:], (0, 0.3 - 0.3 * np.cos(0.1)), atol=1e-15)
    assert not moved[[0, 2]].any()


@pytest.mark.parametrize("released", [0, 1, 2, 5])
def test_the_keyframe_lifts_the_released_balls_to_the_left(released: int) -> None:
    xml = cm.row("AAAAA", released=released, release=20)
    model, data = at_rest(xml)
    assert not model.qpos0.any()
    rest = data.geom_xpos.copy()
    mujoco.mj_resetDataKeyframe(model, data, model.key("release").id)
    mujoco.mj_forward(model, data)
    lifted = data.geom_xpos - rest
    assert not data.qvel.any()
    expected = np.zeros((5, 3))
    angle = np.radians(20)
    expected[:released, 0] = -0.3 * np.sin(angle)
    expected[:released, 2] = 0.3 * (1 - np.cos(angle))
    np.testing.assert_allclose(lifted, expected, atol=1e-15)


def test_options_reach_the_model() -> None:
    model, _ = at_rest(
        cm.row("AA", timestep=5e-4, integrator="RK4", gravity=1.62, name="moon <1>")
    )
    assert model.opt.timestep == 5e-4
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    np.testing.assert_array_equal(model.opt.gravity, (0, 0, -1.62))
    assert model.names.split(b"\0")[0] == b"moon <1>"


def test_balls_other_than_a_and_b_can_be_mixed_in() -> None:
    steel, glass = cm.Ball(0.2, 0.018), cm.Ball(0.0123, 0.0111)
    model, data = at_rest(cm.row([steel, glass, steel]))
    np.testing.assert_allclose(model.body_mass[1:], (0.2, 0.0123, 0.2), rtol=1e-15)
    np.testing.assert_allclose(gaps(model, data), 0, atol=TOUCHING)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: cm.row("ACA"), ("'C'", "['A', 'B']")),
        (lambda: cm.row(""), ("no ball",)),
        (lambda: cm.row(cast(Any, [1.0])), ("1.0", "Ball")),
        (lambda: cm.row("AAA", gap=(0.0,)), ("1 values", "2 pairs")),
        (lambda: cm.row("AA", gap=-0.03), ("-0.03",)),
        (lambda: cm.row("AA", gap=float("nan")), ("nan",)),
        (lambda: cm.row("AA", length=0.0), ("length", "0.0", "> 0")),
        (lambda: cm.row("AA", release=180.0), ("release", "180.0", "179")),
        (lambda: cm.row("AA", released=3), ("released", "3", "2")),
        (lambda: cm.row("AA", timestep=-1.0), ("timestep", "-1.0")),
        (
            lambda: cm.row("AA", integrator=cast(Any, "euler")),
            ("'euler'", "Euler", "RK4"),
        ),
        (lambda: cm.row("AA", gravity=-9.81), ("gravity", "-9.81")),
        (lambda: cm.Ball(0.0, 0.01), ("Ball.mass", "0.0")),
        (lambda: cm.Ball(0.1, float("inf")), ("Ball.radius", "inf")),
        (lambda: cm.two_string("AA", length=0.01), ("length",)),
        (lambda: cm.two_string("AA", release=90.0), ("release", "90.0", "80")),
        (lambda: cm.lattice(0, 3), ("rows", "0", "1")),
        (lambda: cm.lattice(3, 3, released=cast(Any, "row")), ("'row'", "'corner'")),
        (lambda: cm.free_balls(1), ("count", "1", "2")),
        (lambda: cm.free_balls(3, spacing=0.01), ("spacing",)),
    ],
)
def test_a_bad_parameter_is_named_with_its_value_and_what_is_allowed(
    make: Callable[[], object], words: tuple[str, ...]
) -> None:
    with pytest.raises(cm.CradleModelError) as caught:
        make()
    assert isinstance(caught.value, ValueError)
    for word in words:
        assert word in str(caught.value)
