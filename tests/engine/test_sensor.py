"""The sensor: what impacts do to each owned geom; MuJoCo's sensors see nothing."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, free_row, header, pendulums, step_to_impact

import mujoco_impact

NUMBERS = 11
"""Force (3), impulse, peak, alpha, count, impulse since reset (3), largest peak."""
MASSES = (0.115, 0.230, 0.115)


def readings(data) -> np.ndarray:
    """One row per owned geom, of the state the last step started from."""
    return data.sensor("impact").data.reshape(-1, NUMBERS).copy()


def test_there_are_eleven_numbers_per_owned_geom():
    model, data = free_row(MASSES, start=3e-3)
    assert data.sensor("impact").data.shape == (3 * NUMBERS,)
    mujoco.mj_step(model, data)
    np.testing.assert_array_equal(readings(data), 0)
    step_to_impact(model, data)
    assert np.any(readings(data) != 0)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_force_times_timestep_adds_up_to_the_change_of_momentum(integrator, duration):
    model, data = free_row(
        MASSES, integrator=integrator, duration=duration, gap=0.02, depth=0.014
    )
    before = data.qvel.reshape(3, 6)[:, :3].copy()
    delivered = np.zeros((3, 3))
    for _ in range(40):
        mujoco.mj_step(model, data)
        delivered += readings(data)[:, :3] * model.opt.timestep
    after = data.qvel.reshape(3, 6)[:, :3]
    change = np.array(MASSES)[:, None] * (after - before)
    assert np.abs(change).max() > 0.01
    # sums of a few numbers of 1e-2 N s
    np.testing.assert_allclose(delivered, change, rtol=0, atol=1e-15)


def test_action_equals_reaction_in_every_step():
    model, data = free_row(MASSES, duration=7.5e-3, gap=0.02, depth=0.014)
    largest = 0.0
    for _ in range(40):
        mujoco.mj_step(model, data)
        force = readings(data)[:, :3]
        largest = max(largest, np.abs(force).max())
        assert np.abs(force.sum(axis=0)).max() <= 1e-15 * max(largest, 1)
    assert largest > 1


def test_after_the_impact_it_tells_impulse_peak_alpha_and_count():
    model, data = free_row(MASSES, duration=7.5e-3, gap=0.02, depth=0.014)
    for _ in range(40):
        mujoco.mj_step(model, data)
    first, second = header(model, data).pulses[:2]
    found = readings(data)
    np.testing.assert_array_equal(found[:, :3], 0)
    P, alpha, W = first[4], first[5], first[6]
    H = np.pi * P / (2 * W)
    np.testing.assert_allclose(found[0, 3:7], [P, H, alpha, 1], rtol=1e-14)
    P = second[4]
    np.testing.assert_allclose(found[2, 3], P, rtol=1e-14)
    np.testing.assert_allclose(found[2, 4], np.pi * P / (2 * W), rtol=1e-14)
    # the middle ball took part in both
    np.testing.assert_array_equal(found[:, 6], [1, 2, 1])


def test_alpha_of_an_isolated_impact_is_one():
    """alpha = P / P_ref, P_ref = (1 + e) mu u of the contact that closes first."""
    model, data = free_row(MASSES[:2], restitution=0.7)
    for _ in range(10):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(readings(data)[:, 5], 1, rtol=1e-14)


def test_the_order_is_that_of_the_tuple():
    model, data = free_row(MASSES, geoms=["ball2", "ball0", "ball1"])
    for _ in range(10):
        mujoco.mj_step(model, data)
    np.testing.assert_array_equal(readings(data)[:, 6], [1, 1, 2])


def test_the_sensor_agrees_with_forward_before_the_step():
    """mj_forward and the step that follows it see the same impact."""
    model, data = pendulums("AAA")
    twin = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, twin, 0)
    seen = 0
    for _ in range(160):
        mujoco.mj_forward(model, twin)
        expected = twin.sensor("impact").data.copy()
        mujoco.mj_step(model, twin)
        mujoco.mj_step(model, data)
        np.testing.assert_array_equal(data.sensor("impact").data, expected)
        seen += int(expected[0] != 0)
    assert seen > 0


def test_reset_clears_the_records():
    model, data = pendulums("AAA")
    step_to_impact(model, data)
    mujoco.mj_step(model, data)
    assert readings(data)[0, 6] == 1
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(readings(data), 0)


DROP = """
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom type="plane" size="1 1 1" condim="1"/>
    <body pos="0 0 .3">
      <freejoint/><geom name="foot" {shape} mass="1" condim="1"/>
    </body>
  </worldbody>
</mujoco>
"""


def landed(shape, **options):
    """A foot after its first bounce, and its readings while it fell and rose."""
    xml = DROP.format(shape=shape)
    model = mujoco_impact.attach(xml, **options).compile()
    data = mujoco.MjData(model)
    seen = []
    while data.time < 0.3:
        mujoco.mj_step(model, data)
        seen.append(readings(data)[0])
    return model, data, np.array(seen)


@pytest.mark.parametrize(
    "shape", ['type="sphere" size=".05"', 'type="box" size=".05 .05 .05"']
)
@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_a_landing_is_one_impact_in_however_many_points(shape, duration):
    """A box on its four corners reports what a sphere does."""
    restitution = 0.5
    model, data, seen = landed(shape, restitution=restitution, duration=duration)
    pulses = header(model, data).count
    assert pulses == (4 if "box" in shape else 1)
    reading = seen[-1]
    assert reading[6] == 1
    # (1 + e) m u of a fall of .25 m; gravity acts on in the step
    speed = np.sqrt(2 * 9.81 * 0.25)
    assert reading[3] == pytest.approx((1 + restitution) * speed, rel=1e-2)
    heights = header(model, data).pulses[:pulses, 8]
    assert reading[4] == pytest.approx(heights.sum(), rel=1e-12)
    assert reading[10] == reading[4]


def test_what_was_exerted_since_reset_survives_any_decimation():
    """Every reading of the sum is the integral of all forces before it."""
    *_, seen = landed('type="box" size=".05 .05 .05"', restitution=0.5)
    exerted = np.cumsum(seen[:, :3] * 0.002, axis=0)
    np.testing.assert_allclose(seen[:, 7:10], exerted, rtol=0, atol=1e-14)
    assert seen[-1, 9] > 1
    # never less than before
    assert np.all(np.diff(seen[:, 6]) >= 0)
    assert np.all(np.diff(seen[:, 10]) >= 0)


@pytest.mark.parametrize("restitution", [1.0, 0.6, 0.0])
def test_the_peak_of_a_hertz_contact_is_its_largest_force(restitution):
    """F = K y_max^(3/2), y_max = (5 mu u^2 / 4 K)^(2/5); the waveform has .85 of it."""
    speed, radius, mass = 0.5, 0.015, 0.115
    model, data = free_row([mass, mass], restitution=restitution, speed=speed)
    for _ in range(5):
        mujoco.mj_step(model, data)
    modulus = 2e11 / (2 * (1 - 0.3**2))
    stiffness = 4 / 3 * modulus * np.sqrt(radius / 2)
    deepest = (1.25 * mass / 2 * speed**2 / stiffness) ** 0.4
    expected = stiffness * deepest**1.5
    assert readings(data)[0, 4] == pytest.approx(expected, rel=1e-9)


def row_peaks(count, mass, stiffness, speed):
    """Largest force of each contact of a row, by Runge-Kutta steps of 0.1 us."""
    W = (2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)) / mass
    force = lambda y: stiffness * np.maximum(y, 0) ** 1.5  # noqa: E731
    y, c, h = np.zeros(count), np.zeros(count), 1e-7
    c[0] = speed
    peaks = np.zeros(count)
    for _ in range(5000):
        a1 = -W @ force(y)
        a2 = -W @ force(y + h / 2 * c)
        a3 = -W @ force(y + h / 2 * c + h * h / 4 * a1)
        a4 = -W @ force(y + h * c + h * h / 2 * a2)
        y = y + h * c + h * h / 6 * (a1 + a2 + a3)
        c = c + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        peaks = np.maximum(peaks, force(y))
    return peaks


def test_every_contact_of_a_row_has_the_peak_of_its_own():
    """The last is pressed after a wait, in which its waveform is already under way."""
    mass, radius, speed = 0.115, 0.015, 0.5
    model, data = free_row([mass] * 5, speed=speed)
    for _ in range(5):
        mujoco.mj_step(model, data)
    modulus = 2e11 / (2 * (1 - 0.3**2))
    stiffness = 4 / 3 * modulus * np.sqrt(radius / 2)
    found = header(model, data).pulses[:4, 8]
    # the law looks at forces at its steps, some thirty a contact
    expected = row_peaks(4, mass, stiffness, speed)
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_the_peak_of_a_chosen_duration_is_that_of_the_waveform():
    model, data = free_row([0.1, 0.1], duration=7.5e-3, gap=0.02, depth=0.014)
    for _ in range(20):
        mujoco.mj_step(model, data)
    _, _, _, _, P, _, W, *_ = header(model, data).pulses[0]
    assert readings(data)[0, 4] == pytest.approx(np.pi * P / (2 * W), rel=1e-12)
