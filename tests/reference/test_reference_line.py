"""Final velocities of the first impact against independent integrations.

The tables are DOP853 integrations (rtol 1e-12, atol 1e-14, restarted at every opening
and closing of a contact) of the Hertz chain, made by another program; the rows with
restitution 0.9 integrate the bi-stiffness law of Liu, Zhao and Brogliato and the law of
Hunt and Crossley. Velocities in fractions of the impact speed.
"""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import cradle_models as cm
from mujoco_impact import reference

ELASTIC = {
    ("AAA", 1): (-0.0709523536498, 0.0764030390697, 0.99454931458),
    ("AAA", 2): (0.00545068542004, 0.92359696093, 1.07095235365),
    ("AAAA", 2): (-0.111311951069, 0.144616125183, 0.855383874817, 1.11131195107),
    ("AAAAA", 1): (
        -0.0710850170871,
        -0.0302737640966,
        -0.014463629032,
        0.127044986068,
        0.988777424147,
    ),
    ("AAAAA", 2): (
        -0.112614979026,
        -0.0419595005333,
        0.214485776195,
        0.800366671701,
        1.13972203166,
    ),
    ("ABA", 1): (-0.361985920698, 0.249613728654, 0.862758463391),
    ("BAA", 1): (0.161980666737, 0.316976282565, 1.35906238396),
    ("BAB", 1): (-0.136122574013, 0.355827683354, 0.958208732336),
}

BISTIFFNESS = {
    ("AAA", 1): (-0.00861535615488, 0.104142798515, 0.90447255764),
    ("AAAAA", 1): (
        -0.00867062940678,
        0.0237768715533,
        0.0330655614243,
        0.124262570389,
        0.82756562604,
    ),
    ("AAAAA", 2): (
        -0.00718265069689,
        0.0437179463324,
        0.230508911288,
        0.737597085652,
        0.995358707424,
    ),
    ("ABA", 1): (-0.291007688834, 0.253107331182, 0.784793026469),
    ("BAA", 1): (0.216059535947, 0.324584050632, 1.24329687747),
    ("BAB", 1): (-0.0578157855103, 0.37193045899, 0.871850556015),
}

HUNT_CROSSLEY = {
    ("AAA", 1): (-0.0391314613448, 0.122916444531, 0.916215016813),
    ("BAA", 1): (0.176427523108, 0.394294519679, 1.25285043411),
}

# Resting gaps of AAA over the largest compression of a pair, and the velocities.
GAPS = {
    0.001: (-0.07064010018688126, 0.07604079724859492, 0.9945993029382864),
    0.03: (-0.062178526785598695, 0.06631930985193689, 0.9958592169336618),
    0.1: (-0.045444944914093795, 0.04761343730883484, 0.9978315076052588),
    0.5: (-0.006057858091631104, 0.006094780771955068, 0.9999630773196762),
    1.0: (-0.00013841692850050162, 0.0001384360905214656, 0.9999999808379795),
}


def impact(pattern: str, n_incoming: int = 1, **options: Any) -> reference.FirstImpact:
    row = cm.balls(pattern)
    masses = [ball.mass for ball in row]
    radii = [ball.radius for ball in row]
    return reference.first_impact(masses, radii, n_incoming=n_incoming, **options)


@pytest.mark.parametrize(("case", "expected"), ELASTIC.items(), ids=str)
def test_elastic_velocities_are_those_of_the_hertz_chain(
    case: tuple[str, int], expected: tuple[float, ...]
) -> None:
    # Both sides are integrated to some 1e-11.
    np.testing.assert_allclose(impact(*case).velocities, expected, atol=1e-9)


@pytest.mark.parametrize(("case", "expected"), BISTIFFNESS.items(), ids=str)
def test_bistiffness_velocities_are_those_of_liu_zhao_and_brogliato(
    case: tuple[str, int], expected: tuple[float, ...]
) -> None:
    found = impact(*case, restitution=0.9, dissipation="bistiffness")
    np.testing.assert_allclose(found.velocities, expected, atol=1e-9)


@pytest.mark.parametrize(("case", "expected"), HUNT_CROSSLEY.items(), ids=str)
def test_viscous_velocities_are_those_of_hunt_and_crossley(
    case: tuple[str, int], expected: tuple[float, ...]
) -> None:
    found = impact(*case, restitution=0.9, dissipation="hunt-crossley")
    np.testing.assert_allclose(found.velocities, expected, atol=1e-9)


@pytest.mark.parametrize(("share", "expected"), GAPS.items(), ids=str)
def test_gaps_of_a_fraction_of_the_compression_matter(
    share: float, expected: tuple[float, ...]
) -> None:
    stiffness = reference.hertz_stiffness(0.015, 0.015, 2e11, 0.3)
    for speed in (1.0, 0.2):
        deepest = reference.largest_compression(0.0575, stiffness, speed)
        found = impact("AAA", gap=share * deepest, speed=speed)
        np.testing.assert_allclose(found.velocities, expected, atol=1e-9)


def sequential(masses: list[float], restitution: float) -> NDArray[np.float64]:
    """Pairwise impacts, left to right, until no pair closes."""
    velocity = np.array([1.0] + [0.0] * (len(masses) - 1))
    while True:
        closing = velocity[:-1] - velocity[1:]
        if closing.max() < 1e-14:
            return velocity
        k = int(np.argmax(closing > 1e-14))
        reduced = masses[k] * masses[k + 1] / (masses[k] + masses[k + 1])
        impulse = (1 + restitution) * reduced * closing[k]
        velocity[k] -= impulse / masses[k]
        velocity[k + 1] += impulse / masses[k + 1]


@pytest.mark.parametrize("pattern", ["AAAAA", "BAA", "ABA", "BBA"])
@pytest.mark.parametrize("restitution", [1.0, 0.9])
def test_wide_gaps_make_impacts_sequential(pattern: str, restitution: float) -> None:
    masses = [ball.mass for ball in cm.balls(pattern)]
    dissipation = None if restitution == 1 else "bistiffness"
    found = impact(pattern, gap=1e-3, restitution=restitution, dissipation=dissipation)
    expected = sequential(masses, restitution)
    # Each impact in the sequence is integrated to some 1e-11.
    np.testing.assert_allclose(found.velocities, expected, atol=1e-9)


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("dissipation", ["bistiffness", "hunt-crossley"])
def test_a_single_pair_rebounds_with_the_restitution(
    dissipation: reference.Dissipation, restitution: float
) -> None:
    # At the impact speed; the masses do not matter.
    found = impact("AB", restitution=restitution, dissipation=dissipation)
    rebound = found.velocities[1] - found.velocities[0]
    assert pytest.approx(restitution, abs=1e-9) == rebound
    momentum = 0.115 * found.velocities[0] + 0.230 * found.velocities[1]
    assert pytest.approx(0.115, rel=1e-12) == momentum


def test_an_elastic_pair_lasts_and_pushes_as_in_closed_form() -> None:
    stiffness = reference.hertz_stiffness(0.015, 0.01905, 2e11, 0.3)
    reduced = 0.115 * 0.230 / 0.345
    found = impact("AB", speed=0.7)
    expected = reference.contact_time(reduced, stiffness, 0.7)
    # The force vanishes like the 1.5th power: the end is known less well.
    assert pytest.approx(expected, rel=1e-6) == found.duration
    assert pytest.approx(2 * reduced * 0.7, rel=1e-9) == found.impulses[0]


def test_touching_rows_do_not_depend_on_speed_or_stiffness() -> None:
    base = impact("AABA").velocities
    different: list[dict[str, Any]] = [{"speed": 1e-3}, {"young": 3e9}, {"speed": 20.0}]
    for options in different:
        np.testing.assert_allclose(
            impact("AABA", **options).velocities, base, atol=1e-9
        )


def test_a_mirrored_pair_of_balls_leaves_a_mirrored_pair() -> None:
    """Two of four balls come in: seen from the centre of mass, a mirror image."""
    for options in (
        {},
        {"restitution": 0.9, "dissipation": "bistiffness"},
        {"restitution": 0.7, "dissipation": "hunt-crossley"},
    ):
        velocity = impact("AAAA", 2, **options).velocities
        np.testing.assert_allclose(velocity + velocity[::-1], 1, atol=1e-9)


# A few random rows: each takes some hundredths of a second.
@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    ratios=st.lists(st.floats(0.2, 5.0), min_size=2, max_size=4),
    restitution=st.sampled_from((1.0, 0.8)),
    gap=st.sampled_from((0.0, 1e-6)),
)
def test_momentum_is_kept_energy_is_not_won_and_balls_separate(
    ratios: list[float], restitution: float, gap: float
) -> None:
    masses = 0.1 * np.array(ratios)
    radii = 0.015 * np.cbrt(ratios)
    found = reference.first_impact(
        masses.tolist(),
        radii.tolist(),
        gap=gap,
        restitution=restitution,
        dissipation=None if restitution == 1 else "bistiffness",
    )
    velocity = found.velocities
    assert pytest.approx(masses[0], rel=1e-11) == masses @ velocity
    energy = masses @ velocity**2 / masses[0]
    assert pytest.approx(energy, rel=1e-12) == found.energy_ratio
    if restitution == 1:
        assert pytest.approx(1, abs=1e-9) == energy
    else:
        assert energy < 1
    assert (np.diff(velocity) > -1e-11).all()
    assert (found.impulses >= 0).all()
