"""The buffer of forces: nothing of an impulse is lost between two readings."""

import mujoco
import numpy as np
import pytest

import cradle_models
import mujoco_impact
from mujoco_impact.envs import ForceBuffer
from mujoco_impact.errors import ConfigError, SceneError
from mujoco_impact.sensor import read_sensor, sensor_slice

RATE = 40_000


def swing(pattern="AAA", **settings):
    xml = cradle_models.row(pattern)
    model = mujoco_impact.attach(xml, **settings).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    pairs = [(f"ball_{i}", f"ball_{i + 1}") for i in range(1, len(pattern))]
    return model, data, pairs


@pytest.mark.parametrize("rate", [1_000, 40_000, 200_000])
@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_it_integrates_to_the_impulse_of_the_sensor(rate, duration):
    """At any rate: a sample is the exact average over its interval."""
    model, data, pairs = swing("AA", duration=duration)
    buffer = ForceBuffer(model, data, pairs, duration=0.05, rate=rate)
    where = sensor_slice(model)
    while read_sensor(data.sensordata[where]).count[0] == 0:
        mujoco.mj_step(model, data)
        buffer.poll()
    mujoco.mj_step(model, data, nstep=6)
    buffer.poll()
    impulse = read_sensor(data.sensordata[where]).impulse
    assert impulse[0] > 0.05
    found = buffer.read().sum(axis=0) / rate
    np.testing.assert_allclose(found, impulse[:1], rtol=1e-9)


@pytest.mark.parametrize("every", [1, 3, 10])
def test_readings_one_after_another_hold_every_impulse_once(every):
    """3 s of five balls, tens of impacts, some over the end of a step."""
    model, data, pairs = swing("AAAAA", restitution=0.9)
    h = float(model.opt.timestep)
    buffer = ForceBuffer(model, data, pairs, duration=every * h)
    reader = mujoco_impact.pulses.PulseReader(model, data)
    total = np.zeros(4)
    for step in range(1500):
        mujoco.mj_step(model, data)
        reader.poll()
        buffer.poll()
        if (step + 1) % every == 0:
            total += buffer.read().sum(axis=0) / RATE
    expected = np.zeros(4)
    for impact in reader.impacts:
        if impact.time + impact.duration < data.time:
            expected[pairs.index(impact.geoms)] += impact.impulse
    assert len(reader.impacts) > 30
    assert buffer.missed == 0
    np.testing.assert_allclose(total, expected, rtol=1e-9)


def test_the_samples_are_the_waveform():
    """A half sine of the duration set, with its peak in the middle."""
    model, data, pairs = swing("AA", duration=5e-3)
    buffer = ForceBuffer(model, data, pairs, duration=0.01)
    reader = mujoco_impact.pulses.PulseReader(model, data)
    while not reader.impacts:
        mujoco.mj_step(model, data)
        reader.poll()
        buffer.poll()
    mujoco.mj_step(model, data, nstep=3)
    (impact,) = reader.impacts
    force = buffer.read()[:, 0]
    middle = data.time - 0.01 + (np.arange(400) + 0.5) / RATE
    phase = np.clip((middle - impact.time) / 5e-3, 0, 1)
    # the average over 25 us is the middle to 1e-5 H, but where the sine begins and
    # ends: (pi/200)/8 H
    np.testing.assert_allclose(
        force, impact.height * np.sin(np.pi * phase), atol=2.1e-3 * impact.height
    )


def test_other_contacts_are_left_out():
    model, data, pairs = swing("AAA")
    buffer = ForceBuffer(model, data, pairs[1:], duration=0.4)
    mujoco.mj_step(model, data, nstep=200)
    buffer.poll()
    assert buffer.read().shape == (16000, 1)
    assert buffer.read().sum() > 0


def test_impacts_whose_slot_was_used_again_are_counted():
    model, data, pairs = swing("AAAAA", restitution=0.9)
    buffer = ForceBuffer(model, data, pairs, duration=0.02)
    mujoco.mj_step(model, data, nstep=1500)
    buffer.poll()
    assert buffer.missed > 0


def test_bad_arguments_are_refused_with_a_reason():
    model, data, pairs = swing("AA")
    with pytest.raises(SceneError, match="there is no geom 'ball_7'"):
        ForceBuffer(model, data, [("ball_1", "ball_7")], duration=0.02)
    for duration, rate in ((0.02, 12_345), (0.0, RATE), (np.inf, RATE)):
        with pytest.raises(ConfigError, match="whole number"):
            ForceBuffer(model, data, pairs, duration=duration, rate=rate)
