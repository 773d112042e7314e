"""Readings of equation (6) that the paper leaves open, held against its own numbers.

The first contact gets P_12 = c alpha_1 S_h p (W_0 + kappa S_w/p 1e-3), c the area of
the waveform of unit height and duration. Physics gives P_12/p (Hertz impact, e = .95),
table 3 the rest, so eight patterns tell how well a kappa and one c for all of them do.
What feeds the second contact is tried on the five printed P tables.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import cradle_models
from mujoco_impact import law
from mujoco_impact.calibration import DEFAULT_KAPPA, DEFAULT_W0
from mujoco_impact.calibration.synthetic import hertz_truth
from mujoco_impact.paper.patterns import RESTITUTION, drop_speed
from mujoco_impact.paper.printed import printed

KAPPAS = (1.0, 0.1, DEFAULT_KAPPA, 0.01, 0.0)
"""Units of S_w/p: 1 is SI, .01 takes kg cm/s, 0 leaves S_w out."""


@dataclass(frozen=True)
class FirstContact:
    """One reading of the unit of S_w.

    Attributes:
        kappa: Factor that gives S_w/p the unit ms.
        area: Area c that fits best.
        miss: RMS of ln(printed/physical) over the eight patterns with that area.
    """

    kappa: float
    area: float
    miss: float


@dataclass(frozen=True)
class SecondContact:
    """One reading of what feeds the waveform of contact 2.

    Attributes:
        feed: The momentum in equation (6).
        miss: RMS of ln(P_23/P_12 by (6) / as printed) over the five printed tables.
    """

    feed: str
    miss: float


def first_contact(kappa: float) -> FirstContact:
    """Returns how well one kappa explains the first contact of table 3."""
    factors = [
        _first_factor(pattern, kappa) for pattern in cradle_models.PAPER_PATTERNS
    ]
    logarithm = np.log(factors)
    return FirstContact(kappa, float(np.exp(-logarithm.mean())), float(logarithm.std()))


def best_kappa() -> FirstContact:
    """Returns the kappa that explains the first contact of table 3 best."""
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda kappa: first_contact(kappa).miss, bounds=(0, 1), method="bounded"
    )
    return first_contact(float(found.x))


def second_contact() -> tuple[SecondContact, ...]:
    """Returns how well each feed explains the printed impulses of contact 2."""
    given = [printed(pattern) for pattern in cradle_models.PAPER_PATTERNS]
    tables = [one for one in given if one.impulse is not None]
    speed = drop_speed()
    misses: dict[str, list[float]] = {}
    for one in tables:
        assert one.impulse is not None
        P12, P23 = -float(one.impulse[0, 2]), float(one.impulse[2, 2])
        masses, alpha = one.masses.tolist(), one.parameters.alpha
        p = masses[0] * speed
        for feed, momentum in {
            "the same as contact 1 (one common waveform)": p,
            "P_12, what contact 1 hands over": P12,
            "m_2 times the drop speed": masses[1] * speed,
            "reduced mass of 2 and 3 times the drop speed": speed
            * masses[1]
            * masses[2]
            / (masses[1] + masses[2]),
        }.items():
            width = _width(one.parameters.sw, momentum) / _width(one.parameters.sw, p)
            ratio = alpha[1] / alpha[0] * momentum / p * width
            misses.setdefault(feed, []).append(float(np.log(ratio / (P23 / P12))))
    return tuple(
        SecondContact(feed, float(np.sqrt(np.mean(np.square(values)))))
        for feed, values in misses.items()
    )


def _first_factor(pattern: str, kappa: float) -> float:
    """Returns alpha_1 S_h W over the physical P_12/p, which is 1/c."""
    given = printed(pattern)
    p = float(given.masses[0]) * drop_speed()
    width = _width(given.parameters.sw, p, kappa)
    height = given.parameters.alpha[0] * given.parameters.sh
    truth = hertz_truth(cradle_models.balls(pattern), restitution=RESTITUTION)
    return height * width / float(truth.share[0])


def _width(sw: float, momentum: float, kappa: float = DEFAULT_KAPPA) -> float:
    """Returns W of equation (6) [s]."""
    return law.calibrated_duration(momentum, sw=sw, w0=DEFAULT_W0, kappa=kappa)
