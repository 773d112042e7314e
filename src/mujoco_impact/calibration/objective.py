"""The evaluation value of Dondo and Noborio, section 2.5, for many candidates at once.

With the momentum p = m_1 u_z of the ball that comes in, the common waveform has

    H = S_h p,   W = kappa S_w / p 1e-3 + W_0,   P = (2/pi) H W                    (6)

contact k gives the impulse V_k = alpha_k P n_k + Q_k t_k to ball k + 1 and -V_k to
ball k (10)-(12), Q_k the friction of (7)-(9) along the slip t_k, and

    evaluation = mean over shots of the sum over balls of |m dv - (V_(k-1) - V_k)|

in [kg m/s]. |.| is the length of the vector; the paper does not say which norm it
means.
E does not appear: it shapes the waveform, not the impulse.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from mujoco_impact import law
from mujoco_impact.calibration.shots import Array, Shots

DEFAULT_W0 = 7.5e-3
"""Mean duration of an impact that the paper measured [s]."""

DEFAULT_KAPPA = 0.083
"""Factor that gives S_w/p the unit ms; see docs/paper.md."""

NO_SLIP = 1e-9
"""A slip slower than this part of the closing speed has no direction."""


@dataclass(frozen=True)
class Candidates:
    """Parameters of many candidates; every array has one entry per candidate.

    Attributes:
        sh: S_h [N s/(kg m)], shape (candidates,).
        sw: S_w, shape (candidates,).
        mu_s: Static friction factor, shape (candidates,).
        mu_d: Dynamic friction factor, shape (candidates,).
        alpha: alpha_k, shape (candidates, contacts).
    """

    sh: Array
    sw: Array
    mu_s: Array
    mu_d: Array
    alpha: Array


@dataclass(frozen=True)
class Objective:
    """The evaluation value on a set of shots.

    Attributes:
        shots: The shots.
        w0: W_0 of equation (6) [s].
        kappa: Unit factor of the S_w term of equation (6).
    """

    shots: Shots
    w0: float = DEFAULT_W0
    kappa: float = DEFAULT_KAPPA

    @cached_property
    def momentum_change(self) -> Array:
        """Change of momentum m dv [kg m/s], shape (shots, balls, 3)."""
        return self.shots.momentum_change

    @cached_property
    def momentum(self) -> Array:
        """What comes in, p = m_1 u_z [kg m/s], shape (shots,)."""
        return self.shots.momentum

    @cached_property
    def slip(self) -> tuple[Array, Array, Array]:
        """Momenta N_0 and T_0 [kg m/s], (shots, contacts), and t, (..., 3).

        The m of equations (7) and (8) is the mass of the ball on the incoming side.
        """
        shots = self.shots
        u_z = np.maximum(shots.closing_speeds, 0.0)
        u_t = shots.relative_velocities
        u_t = u_t - shots.closing_speeds[..., np.newaxis] * shots.directions
        speed = np.linalg.norm(u_t, axis=2)
        still = speed <= NO_SLIP * u_z[:, :1]
        speed = np.where(still, 0.0, speed)
        t = u_t / np.where(still, 1.0, speed)[..., np.newaxis]
        m = shots.masses[:-1]
        return m * u_z, m * speed, np.where(still[..., np.newaxis], 0.0, t)

    def common_impulse(self, sh: Array, sw: Array) -> Array:
        """Returns P of equation (6) [N s], shape (candidates, shots)."""
        # P = (2/π) S_h (κ S_w 1e-3 + W₀ p)
        width = self.kappa * sw[:, np.newaxis] * 1e-3 + self.w0 * self.momentum
        impulse: Array = 2 / np.pi * sh[:, np.newaxis] * width
        return impulse

    def friction(self, impulse: Array, mu_s: Array, mu_d: Array) -> Array:
        """Returns Q of normal impulses (candidates, shots, contacts), same shape."""
        normal, tangential, _ = self.slip
        return law.friction_impulse(
            impulse,
            mu_s=mu_s[:, np.newaxis, np.newaxis],
            mu_d=mu_d[:, np.newaxis, np.newaxis],
            normal_momentum=normal,
            slip_momentum=tangential,
        )

    def impulses(self, candidates: Candidates) -> Array:
        """Returns the impulse on each ball [N s], (candidates, shots, balls, 3)."""
        common = self.common_impulse(candidates.sh, candidates.sw)
        P = common[:, :, np.newaxis] * candidates.alpha[:, np.newaxis, :]
        Q = self.friction(P, candidates.mu_s, candidates.mu_d)
        return self.on_balls(P, Q)

    def on_balls(self, P: Array, Q: Array) -> Array:
        """Returns V_(k-1) - V_k for normal and tangential impulses of the contacts."""
        _, _, t = self.slip
        V = P[..., np.newaxis] * self.shots.directions + Q[..., np.newaxis] * t
        balls = np.zeros((*V.shape[:-2], V.shape[-2] + 1, 3))
        balls[..., 1:, :] += V
        balls[..., :-1, :] -= V
        return balls

    def errors(self, impulses: Array) -> Array:
        """Returns the sum over the balls of |m dv - P|, shape (candidates, shots)."""
        residual = self.momentum_change - impulses
        errors: Array = np.sqrt((residual**2).sum(axis=-1)).sum(axis=-1)
        return errors

    def __call__(self, candidates: Candidates) -> Array:
        """Returns the evaluation values [kg m/s], shape (candidates,)."""
        value: Array = self.errors(self.impulses(candidates)).mean(axis=1)
        return value


def candidates_of(values: npt.ArrayLike, names: tuple[str, ...]) -> Candidates:
    """Returns candidates from a table, shape (candidates, parameters).

    Args:
        values: One row per candidate.
        names: Names of the columns, as those of `grid.axes`.
    """
    table = np.asarray(values, dtype=np.float64)
    column = {name: table[:, i] for i, name in enumerate(names)}
    first = sum(not name.startswith("alpha") for name in names)
    return Candidates(
        sh=column["sh"],
        sw=column["sw"],
        mu_s=column["mu_s"],
        mu_d=column["mu_d"],
        alpha=table[:, first:],
    )
