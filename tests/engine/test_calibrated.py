"""The law of Dondo and Noborio: equations (6) and (10)-(12) as printed."""

import mujoco
import numpy as np
import pytest
from scenes import free_row, header, step_until_delivered

# pattern A-A-A of the paper's table 3
SH, SW, E = 191.5, 0.487, 0.541
ALPHA = (1.3, 1.136)
KAPPA, W0 = 0.083, 7.5e-3
MASS, SPEED = 0.115, 0.49
SETTINGS = {
    "law": "calibrated",
    "alpha": ALPHA,
    "sh": SH,
    "sw": SW,
    "e": E,
    "gap": 0.02,
    "depth": 0.014,
}


def equation_six(momentum):
    W = W0 + KAPPA * SW / momentum * 1e-3
    return 2 / np.pi * (SH * momentum) * W, W


@pytest.mark.parametrize("timestep", [2e-4, 2e-3, 1e-2])
def test_three_balls_get_what_equations_ten_to_twelve_say(timestep):
    model, data = free_row(
        [MASS] * 3, speed=SPEED, timestep=timestep, passive=False, **SETTINGS
    )
    step_until_delivered(model, data)
    P, W = equation_six(MASS * SPEED)
    v = data.qvel[[0, 6, 12]]
    # m1 v1' = m1 v1 - a1 P; m2 v2' = a1 P - a2 P; m3 v3' = a2 P, to rounding
    expected = np.array([SPEED - ALPHA[0] * P / MASS, (ALPHA[0] - ALPHA[1]) * P / MASS,
                         ALPHA[1] * P / MASS])  # fmt: skip
    np.testing.assert_allclose(v, expected, rtol=0, atol=1e-12 * SPEED)
    assert MASS * v.sum() == pytest.approx(MASS * SPEED, rel=1e-12)
    pulses = header(model, data).pulses[:2]
    np.testing.assert_allclose(pulses[:, 5], ALPHA, rtol=0, atol=0)
    np.testing.assert_allclose(pulses[:, 6], W, rtol=1e-12)


def test_the_guard_stops_the_energy_that_equation_six_injects():
    energies = {}
    for passive in (False, True):
        model, data = free_row(
            [MASS] * 3, speed=0.02, passive=passive, **SETTINGS | {"sw": 1.9}
        )
        step_until_delivered(model, data)
        mujoco.mj_energyVel(model, data)
        energies[passive] = data.energy[1] / (0.5 * MASS * 0.02**2)
    assert energies[False] > 2  # the paper's law at 2 cm/s
    assert energies[True] <= 1 + 1e-12


def test_alpha_goes_by_the_order_of_the_geoms():
    model, data = free_row(
        [MASS] * 3,
        speed=SPEED,
        passive=False,
        geoms=["ball2", "ball1", "ball0"],
        **SETTINGS,
    )
    step_until_delivered(model, data)
    P, _ = equation_six(MASS * SPEED)
    assert data.qvel[12] == pytest.approx(ALPHA[0] * P / MASS, rel=1e-12)
