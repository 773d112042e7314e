"""Impacts in one step are resolved one after the other, whatever else goes on."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS

import mujoco_impact

RADIUS, MASS = 0.01, 0.1


def balls(positions, *, integrator="Euler", timestep=1e-3, memory="1M"):
    """Free balls of one size without gravity."""
    bodies = "".join(
        f'<body pos="{x!r} {y!r} {z!r}"><freejoint/>'
        f'<geom size="{RADIUS}" mass="{MASS}"/></body>'
        for x, y, z in np.asarray(positions, dtype=float).tolist()
    )
    return f"""
    <mujoco>
      <size memory="{memory}"/>
      <option timestep="{timestep!r}" gravity="0 0 0" integrator="{integrator}"/>
      <worldbody>{bodies}</worldbody>
    </mujoco>
    """


def velocities(data):
    return data.qvel.reshape(-1, 6)[:, :3].copy()


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_pulse_under_way_elsewhere_changes_nothing(integrator):
    """A fast ball glances off a second, which meets a third in the same step.

    The second ball flies a radius between the two impacts, so that the line of the
    third turns by half a radian meanwhile: to resolve both with the geometry of the
    first is far off.
    """
    chain = [[0, 0, 0], [0.03, 0.012, 0], [0.052, 0.036, 0]]
    slow_pair = [[5, 0, 0], [5 + 2 * RADIUS + 1e-6, 0, 0]]

    def shot(positions, slow):
        xml = balls(positions, integrator=integrator)
        model = mujoco_impact.attach(
            xml, duration=0.01, depth=1e-4, gap=0.1, restitution=1.0, friction="none"
        ).compile()
        data = mujoco.MjData(model)
        if slow:
            data.qvel[18] = 5e-3
        for _ in range(3):
            mujoco.mj_step(model, data)
        data.qvel[0] = 40.0
        mujoco.mj_step(model, data)
        for _ in range(3):
            mujoco.mj_step(model, data)
        return velocities(data)

    alone, beside = shot(chain, False), shot(chain + slow_pair, True)
    # all three were struck, and the slow pair is in the middle of its pulse
    assert np.all(np.linalg.norm(alone, axis=1) > 1)
    assert 1e-3 < beside[4, 0] < 4.9e-3
    # rounding of other sums, times 40 m/s
    np.testing.assert_allclose(beside[:3], alone, atol=1e-9)


def test_a_dense_crowd_is_resolved_as_far_as_its_impacts_reach():
    """Eighty soft balls, each flying four radii a step in a direction of its own.

    Every pair is a contact that may close while the first lasts: more than half a
    million couplings, of which an impact needs those of touching balls only.
    """
    pitch = 2 * RADIUS
    lattice = pitch * np.array(
        [[i, j, k] for i in range(4) for j in range(4) for k in range(5)]
    )
    direction = np.random.default_rng(5).normal(size=lattice.shape)
    direction /= np.linalg.norm(direction, axis=1)[:, np.newaxis]
    xml = balls(lattice, timestep=4 * RADIUS, memory="200M")
    model = mujoco_impact.attach(
        xml, gap=20 * RADIUS, depth=RADIUS / 2, young=1e7, friction="none"
    ).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.ncon > 2500
    data.qvel.reshape(-1, 6)[:, :3] = direction
    first, second = np.triu_indices(len(lattice), 1)
    for _ in range(4):
        mujoco.mj_step(model, data)
        velocity = velocities(data)
        centres = data.qpos.reshape(-1, 7)[:, :3]
        between = np.linalg.norm(centres[second] - centres[first], axis=1)
        assert not np.any(data.efc_force)
        # half of the depth of both is what may show of an impact
        assert between.min() > 2 * RADIUS - RADIUS / 2
        # rounding of some hundred impacts
        np.testing.assert_allclose(
            velocity.sum(axis=0), direction.sum(axis=0), atol=1e-11
        )
        np.testing.assert_allclose(np.sum(velocity**2), len(lattice), rtol=1e-11)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize(
    "masses", [(0.1, 0.1, 0.05, 0.2), (0.1, 0.1, 0.3, 0.05), (0.2, 0.05, 0.1, 0.1)]
)
def test_what_reaches_a_body_before_its_own_impact_strikes_it_first(masses, integrator):
    """Two pairs in one step, far apart; the first sends a ball at the second pair.

    Against the same at a hundredth of the timestep. In the order in which the impacts
    were seen coming, velocities are off by .9 to 1.5 m/s.
    """
    places = 2 * RADIUS * np.arange(4) + np.cumsum([0, 0.0005, 0.005, 0.0016])
    bodies = "".join(
        f'<body pos="{x!r} 0 0"><joint type="slide" axis="1 0 0"/>'
        f'<geom size="{RADIUS}" mass="{mass}"/></body>'
        for x, mass in zip(places.tolist(), masses, strict=True)
    )
    after = []
    for timestep in (2e-3, 2e-5):
        xml = f"""
        <mujoco>
          <option timestep="{timestep}" gravity="0 0 0" integrator="{integrator}"/>
          <worldbody>{bodies}</worldbody>
        </mujoco>"""
        model = mujoco_impact.attach(xml, speed=20).compile()
        data = mujoco.MjData(model)
        data.qvel[:] = [5, 0, 1, 0]
        mujoco.mj_step(model, data, round(4e-3 / timestep))
        after.append(data.qvel.copy())
    # contacts last .07 ms, in which others come closer: 2e-6 of the speed
    np.testing.assert_allclose(after[0], after[1], atol=2e-5)
