"""Islands of contacts for the tests of the law, and their integration by scipy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from mujoco_impact import law

STIFFNESS = 1.2e10  # two 30 mm steel balls [N/m^1.5]


@dataclass(frozen=True)
class Island:
    """Bodies on a line each, joined by contacts: v [m/s], J [-], M [kg]."""

    mass: np.ndarray  # (bodies,)
    jacobian: np.ndarray  # (contacts, bodies); separation speed J v
    velocity: np.ndarray  # (bodies,)
    stiffness: np.ndarray  # (contacts,)
    gap: np.ndarray  # (contacts,)

    @property
    def delassus(self) -> np.ndarray:
        W = self.jacobian / self.mass @ self.jacobian.T
        return (W + W.T) / 2  # the product is symmetric to rounding only

    @property
    def closing_speed(self) -> np.ndarray:
        return -self.jacobian @ self.velocity

    @property
    def fastest(self) -> float:
        return float(np.abs(self.closing_speed).max(initial=0))

    def solve(self, **options) -> law.ImpactSolution:
        return law.solve_impact(
            self.delassus, self.closing_speed, self.stiffness, gap=self.gap, **options
        )

    def after(self, impulse: np.ndarray) -> np.ndarray:
        """Velocities of the bodies, v + M^-1 J^T P."""
        return self.velocity + self.jacobian.T @ impulse / self.mass

    def energy(self, velocity: np.ndarray) -> float:
        return float(self.mass @ velocity**2) / 2


def row(masses, velocities, *, stiffness=STIFFNESS, gap=0.0) -> Island:
    """Balls on a line, left to right; contact k is between k and k + 1."""
    n = len(masses)
    J = np.zeros((n - 1, n))
    J[np.arange(n - 1), np.arange(n - 1)] = -1
    J[np.arange(n - 1), np.arange(1, n)] = 1
    return island(masses, J, velocities, stiffness=stiffness, gap=gap)


def island(masses, jacobian, velocities, *, stiffness=STIFFNESS, gap=0.0) -> Island:
    contacts = len(jacobian)
    return Island(
        np.array(masses, dtype=float),
        np.array(jacobian, dtype=float),
        np.array(velocities, dtype=float),
        np.broadcast_to(np.asarray(stiffness, dtype=float), contacts).copy(),
        np.broadcast_to(np.asarray(gap, dtype=float), contacts).copy(),
    )


def star(arms: int) -> np.ndarray:
    """Body 0 in the middle, joined to each of the others."""
    J = np.zeros((arms, arms + 1))
    J[:, 0] = -1
    J[np.arange(arms), np.arange(1, arms + 1)] = 1
    return J


def ring(discs: int) -> np.ndarray:
    """Touching discs around a regular polygon, free to part in its plane.

    The bodies are the coordinates x, y of each disc, disc after disc.
    """
    angle = 2 * np.pi * np.arange(discs) / discs
    centre = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    J = np.zeros((discs, 2 * discs))
    for k in range(discs):
        other = (k + 1) % discs
        normal = centre[other] - centre[k]
        normal /= np.linalg.norm(normal)
        J[k, 2 * k : 2 * k + 2] = -normal
        J[k, 2 * other : 2 * other + 2] = normal
    return J


unit = st.floats(-1, 1, allow_nan=False, width=32)


def logarithmic(low: float, high: float):
    """Positive numbers whose logarithm is drawn."""
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


@st.composite
def rows(draw, *, most=30, mass_ratio=10.0, gaps=True) -> Island:
    """Rows of 1 to `most` contacts in which something closes."""
    n = draw(st.integers(1, most)) + 1
    spread = np.sqrt(mass_ratio)
    masses = draw(st.lists(logarithmic(1 / spread, spread), min_size=n, max_size=n))
    velocities = draw(st.lists(unit, min_size=n, max_size=n))
    velocities[0] = 1.0  # at least the first contact closes, and sets the scale
    velocities[1] = min(velocities[1], 0.5)
    stiffness = draw(st.lists(logarithmic(3e9, 3e10), min_size=n - 1, max_size=n - 1))
    touching = st.just(0.0)
    gap = st.one_of(touching, st.floats(0, 1e-4)) if gaps else touching
    between = draw(st.lists(gap, min_size=n - 1, max_size=n - 1))
    return row(masses, velocities, stiffness=stiffness, gap=between)


@st.composite
def strikes(draw, *, most=6) -> Island:
    """Short rows at rest that a ball hits at one end, and maybe another at the other.

    Unlike arbitrary rows they do not amplify rounding: no ball meets the same
    neighbour again after a long flight.
    """
    n = draw(st.integers(2, most)) + 1
    masses = draw(st.lists(st.sampled_from((0.5, 1.0, 2.0)), min_size=n, max_size=n))
    velocities = [1.0] + [0.0] * (n - 2) + [draw(st.sampled_from((0.0, -0.7)))]
    gap = draw(
        st.lists(st.sampled_from((0.0, 0.0, 1e-5)), min_size=n - 1, max_size=n - 1)
    )
    return row(masses, velocities, gap=gap)


@st.composite
def networks(draw) -> Island:
    """Stars, rings and arbitrary couplings of up to 6 contacts, some of them open."""
    kind = draw(st.sampled_from(("star", "ring", "dense")))
    count = draw(st.integers(3, 6))
    if kind == "dense":
        entries = draw(st.lists(unit, min_size=count**2, max_size=count**2))
        # every contact has a body of its own beside those it shares
        J = np.hstack([np.array(entries).reshape(count, count), np.eye(count)])
    else:
        J = star(count) if kind == "star" else ring(count)
    bodies = J.shape[1]
    masses = draw(st.lists(logarithmic(0.3, 3), min_size=bodies, max_size=bodies))
    velocities = np.array(draw(st.lists(unit, min_size=bodies, max_size=bodies)))
    gap = draw(
        st.lists(st.sampled_from((0.0, 0.0, 1e-5)), min_size=len(J), max_size=len(J))
    )
    if kind == "ring":
        masses = np.repeat(masses[::2], 2)
    # the first contact closes with 1 m/s
    velocities -= J[0] * (1.0 + J[0] @ velocities) / (J[0] @ J[0])
    return island(masses, J, velocities, gap=gap)


def integrate(of: Island, *, restitution: float = 1.0) -> np.ndarray:
    """Velocities after the impact by scipy, in body space.

    m v' = J^T F, F = K max(y, 0)^1.5, c = -J v, and y' = c, but c/e^2 where a
    compressed contact expands. No law of this package is involved.
    """
    length = float((of.mass.mean() * of.fastest**2 / of.stiffness.mean()) ** 0.4)
    time = length / of.fastest
    bodies = len(of.mass)

    def rates(_, state):
        velocity, y = state[:bodies], state[bodies:]
        closing = -of.jacobian @ velocity
        force = of.stiffness * np.maximum(y, 0) ** 1.5
        expands = (y > 0) & (closing < 0)
        rate = np.where(expands, closing / restitution**2, closing)
        return np.concatenate([of.jacobian.T @ force / of.mass, rate])

    state = np.concatenate([of.velocity, -of.gap])
    scale = np.repeat([of.fastest, length], [bodies, len(of.gap)])
    for _ in range(200):
        # contacts last about three units of time: none is stepped over
        solution = solve_ivp(
            rates,
            (0, 5 * time),
            state,
            method="DOP853",
            rtol=1e-11,
            atol=1e-12 * scale,
            max_step=0.2 * time,
        )
        state = solution.y[:, -1]
        velocity, y = state[:bodies], state[bodies:]
        closing = -of.jacobian @ velocity
        if np.all(y <= 0) and np.all(closing <= 1e-9 * of.fastest):
            return velocity
    raise AssertionError("the row does not separate")
