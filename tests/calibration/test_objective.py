"""The evaluation value of the paper, against the law of the plugin and by hand."""

import numpy as np
import pytest

import cradle_models
from mujoco_impact import law
from mujoco_impact.calibration import Shots, synthetic_shots
from mujoco_impact.calibration.objective import Candidates, Objective


def candidates(sh=200.0, sw=0.5, mu_s=0.02, mu_d=0.01, alpha=(1.3, 1.1)):
    return Candidates(*(np.array([v]) for v in (sh, sw, mu_s, mu_d)), np.array([alpha]))


def slipping(pattern: str = "ABA", count: int = 5) -> Shots:
    """Shots with slip, in directions of their own."""
    balls = cradle_models.balls(pattern)
    exact = synthetic_shots(balls, count=count)
    random = np.random.default_rng(3)
    turned = exact.directions + 0.05 * random.standard_normal(exact.directions.shape)
    turned /= np.linalg.norm(turned, axis=2, keepdims=True)
    before = exact.before + 0.02 * random.standard_normal(exact.before.shape)
    return Shots(exact.masses, before, exact.after, turned)


def test_it_is_the_sum_over_balls_averaged_over_shots_by_hand():
    """Written out ball by ball with the law's own functions, without arrays."""
    shots = slipping()
    sh, sw, mu_s, mu_d, alpha = 180.0, 0.7, 0.05, 0.03, (1.2, 0.6)
    total = 0.0
    for before, after, n in zip(
        shots.before, shots.after, shots.directions, strict=True
    ):
        u = before[:-1] - before[1:]
        p = shots.masses[0] * (u[0] @ n[0])
        V = []
        for k in range(2):
            P = alpha[k] * law.calibrated_impulse(p, sh=sh, sw=sw)
            slip = u[k] - (u[k] @ n[k]) * n[k]
            m = shots.masses[k]
            Q = law.friction_impulse(
                P,
                mu_s=mu_s,
                mu_d=mu_d,
                normal_momentum=m * max(u[k] @ n[k], 0.0),
                slip_momentum=m * np.linalg.norm(slip),
            )
            V.append(P * n[k] + Q * slip / np.linalg.norm(slip))
        impulse = [-V[0], V[0] - V[1], V[1]]  # (10)-(12)
        change = shots.masses[:, None] * (after - before)
        total += sum(np.linalg.norm(change[i] - impulse[i]) for i in range(3))
    value = Objective(shots)(candidates(sh, sw, mu_s, mu_d, alpha))
    assert value[0] == pytest.approx(total / shots.count, rel=1e-12)  # rounding


def test_only_alpha_times_height_counts():
    shots = slipping()
    one = Objective(shots)(candidates(sh=200.0, alpha=(1.0, 0.8)))
    two = Objective(shots)(candidates(sh=160.0, alpha=(1.25, 1.0)))
    np.testing.assert_allclose(one, two, rtol=1e-12)  # rounding


def test_the_frame_of_the_shots_does_not_matter():
    shots = slipping()
    turn, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    vectors = (shots.before @ turn, shots.after @ turn, shots.directions @ turn)
    turned = Shots(shots.masses, *vectors)
    np.testing.assert_allclose(
        Objective(turned)(candidates()), Objective(shots)(candidates()), rtol=1e-12
    )


def test_friction_acts_against_the_slip_and_on_both_balls():
    shots = slipping()
    objective = Objective(shots)
    rough = objective.impulses(candidates(mu_s=0.0, mu_d=0.05))[0]
    smooth = objective.impulses(candidates(mu_s=0.0, mu_d=0.0))[0]
    assert np.abs(rough.sum(axis=1)).max() < 1e-15  # P_ij = -P_ji
    first = rough[:, 0] - smooth[:, 0]
    slip = shots.relative_velocities[:, 0]
    slip = slip - shots.closing_speeds[:, :1] * shots.directions[:, 0]
    cosine = (first * slip).sum(axis=1)
    cosine /= np.linalg.norm(first, axis=1) * np.linalg.norm(slip, axis=1)
    np.testing.assert_allclose(
        cosine, -1, rtol=0, atol=1e-9
    )  # rounding of a difference


def stepped_friction(N, T, P, mu_s, mu_d, steps=20000):
    """Equations (7)-(9), step by step."""
    before, ds = T, P / steps
    for _ in range(steps):
        if mu_s * abs(N) < T:
            T = max(0.0, T - mu_d * ds)
        N -= ds
    return before - T


@pytest.mark.parametrize("mu_s", [0.0, 0.1, 0.6])
@pytest.mark.parametrize("mu_d", [0.05, 0.3])
@pytest.mark.parametrize("slip", [0.05, 0.4])
def test_friction_is_the_limit_of_small_steps(mu_s, mu_d, slip):
    Q = law.friction_impulse(
        1.8, mu_s=mu_s, mu_d=mu_d, normal_momentum=1.0, slip_momentum=slip
    )
    # a step decides by the state at its start: each change of mode is late by one
    expected = stepped_friction(1.0, slip, 1.8, mu_s, mu_d)
    assert float(Q) == pytest.approx(expected, abs=4 * 1.8 / 20000)
