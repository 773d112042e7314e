"""Free balls that meet anyhow in space: what mechanics conserves is conserved."""

from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import INTEGRATORS, header

import mujoco_impact

TIMESTEP = 1e-3
SPIN = 7.0  # about each axis [rad/s]

# the same clusters in every run
examples = settings(max_examples=12, deadline=None, derandomize=True)


@dataclass(frozen=True)
class Cluster:
    """Balls that touch and rest beside each other, and one that flies at them."""

    mass: np.ndarray
    radius: np.ndarray
    centre: np.ndarray  # at the moment of impact
    velocity: np.ndarray

    @property
    def momentum(self) -> float:
        return float(self.mass @ np.linalg.norm(self.velocity, axis=1))


@st.composite
def clusters(draw) -> Cluster:
    count = draw(st.integers(2, 6))
    mass = draw(st.lists(st.floats(0.05, 0.5), min_size=count, max_size=count))
    radius = np.array(
        draw(st.lists(st.floats(0.01, 0.03), min_size=count, max_size=count))
    )
    random = np.random.default_rng(draw(st.integers(0, 2**31)))
    centre = np.zeros((1, 3))
    while len(centre) < count:
        # the next ball touches one of those that are there and stays clear of others
        n = len(centre)
        partner = random.integers(n)
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        new = centre[partner] + direction * (radius[partner] + radius[n])
        clear = np.linalg.norm(centre - new, axis=1) - radius[:n] - radius[n]
        if np.all(np.delete(clear, partner) > 2e-3):
            centre = np.vstack([centre, new])
            line = -direction
    # the last one is the one that comes in, obliquely; everything drifts
    velocity = np.tile(random.uniform(-1, 1, size=3), (count, 1))
    across = random.normal(size=3)
    velocity[-1] += 2 * line + random.uniform(0, 2) * np.cross(line, across)
    return Cluster(np.array(mass), radius, centre, velocity)


def flying(cluster: Cluster, integrator: str, **options):
    """The cluster a quarter of a step before the impact."""
    start = cluster.centre - TIMESTEP / 4 * cluster.velocity
    balls = "".join(
        f'<body pos="{" ".join(map(str, x))}"><freejoint/>'
        f'<geom name="ball{i}" type="sphere" size="{r}" mass="{m}" condim="1"/>'
        "</body>"
        for i, (m, r, x) in enumerate(
            zip(cluster.mass, cluster.radius, start, strict=True)
        )
    )
    xml = (
        f'<mujoco><option timestep="{TIMESTEP}" gravity="0 0 0" '
        f'integrator="{integrator}"/><worldbody>{balls}</worldbody></mujoco>'
    )
    model = mujoco_impact.attach(xml, **options).compile()
    data = mujoco.MjData(model)
    data.qvel.reshape(-1, 6)[:, :3] = cluster.velocity
    data.qvel.reshape(-1, 6)[:, 3:] = SPIN  # which central forces leave alone
    return model, data


def invariants(model, data):
    """Linear and angular momentum about the origin, kinetic energy."""
    m = model.body_mass[1:, None]
    x = data.qpos.reshape(-1, 7)[:, :3]
    v, w = data.qvel.reshape(-1, 6)[:, :3], data.qvel.reshape(-1, 6)[:, 3:]
    inertia = model.body_inertia[1:]
    rotation = np.empty((len(m), 9))
    for i, quaternion in enumerate(data.qpos.reshape(-1, 7)[:, 3:]):
        mujoco.mju_quat2Mat(rotation[i], quaternion)
    spin = np.einsum("ijk,ik->ij", rotation.reshape(-1, 3, 3), inertia * w)
    angular = np.cross(x, m * v) + spin
    energy = (np.sum(m * v**2) + np.sum(inertia * w**2)) / 2
    return np.sum(m * v, axis=0), angular.sum(axis=0), energy


@pytest.mark.parametrize("integrator", INTEGRATORS)
@examples
@given(cluster=clusters())
def test_elastic_balls_in_space_conserve_momentum_and_energy(integrator, cluster):
    model, data = flying(cluster, integrator)
    p0, L0, T0 = invariants(model, data)
    for _ in range(20):
        mujoco.mj_step(model, data)
    p1, L1, T1 = invariants(model, data)
    pulses = header(model, data).pulses
    assert header(model, data).count > 0
    # rounding of forces of 1e3 N over a step
    assert np.abs(p1 - p0).max() < 1e-12 * cluster.momentum
    # contacts of an impact that follow the first are resolved with the normals of its
    # beginning, so energy is exact however they turn meanwhile
    assert pytest.approx(T0, rel=1e-11) == T1
    # a force through the centre turns no ball: rounding of its arm, 1e-17 m, times
    # speeds over radii squared
    assert np.abs(data.qvel.reshape(-1, 6)[:, 3:] / SPIN - 1).max() < 1e-9
    # The line of centres is that of the moment the first contact closes. By the time
    # half of the impulse P has come, W/2 later, it has turned: P acts off the line by
    # the way the balls slide past each other, at up to twice the fastest speed.
    used = pulses[pulses[:, 0] > 0]
    slide = 2 * np.linalg.norm(cluster.velocity, axis=1).max() * used[:, 6].max()
    assert np.abs(L1 - L0).max() < slide * used[:, 4].sum()


@pytest.mark.parametrize("duration", ["hertz", 4e-3])
@examples
@given(cluster=clusters())
def test_lossy_balls_in_space_keep_momentum_and_lose_energy(duration, cluster):
    options = {"restitution": 0.6, "duration": duration, "depth": 0.009, "gap": 0.02}
    model, data = flying(cluster, "Euler", **options)
    p0, _, T0 = invariants(model, data)
    for _ in range(20):
        mujoco.mj_step(model, data)
    p1, _, T1 = invariants(model, data)
    assert header(model, data).count > 0
    assert np.abs(p1 - p0).max() < 1e-12 * cluster.momentum
    if duration == "hertz":
        # within 4 ms these balls pass each other by their size, and the pulse turns
        # with them: that is what short means in "a pulse is short"
        assert T1 < T0
