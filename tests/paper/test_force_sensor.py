"""The force-sensor experiment: samples, impulses, and when pulses collapse."""

import math

import numpy as np
import pytest
from typer.testing import CliRunner

import cradle_models
from mujoco_impact.cli import app
from mujoco_impact.paper.force_sensor import (
    equivalent_young,
    experiment,
    median_width,
)
from mujoco_impact.paper.patterns import RESTITUTION


@pytest.fixture(scope="module")
def series():
    return experiment()


def test_ten_shots_at_forty_kilohertz(series):
    for one in series:
        assert len(one.records) == 10
        heights = [record.height for record in one.records]
        np.testing.assert_allclose(heights, cradle_models.sensor.HEIGHTS, rtol=1e-9)
        assert {record.sample for record in one.records} == {1 / 40e3}


def test_samples_add_up_to_the_impulse_of_the_swing(series):
    """(1 + e) m v, v = sqrt(2 g h) for a ball that turns with its arm (1e-3)."""
    for one in series:
        for record in one.records:
            total = record.force.sum() * record.sample
            # the arm turns while the pulse lasts, and the rest of it is scaled: 1e-5
            assert total == pytest.approx(record.impact.impulse, rel=3e-5)
            inertia = 1 + 0.4 * (0.015 / 0.3) ** 2
            speed = math.sqrt(2 * 9.81 * record.height / inertia)
            P = (1 + RESTITUTION) * 0.115 * inertia * speed
            assert total == pytest.approx(P, rel=1e-4)  # a step of the swing


def test_one_duration_makes_all_waveforms_one_scaled_in_height(series):
    """Measured: 2.2e-3 (the samples in which pulses begin and end), 2.2e-5."""
    fixed = series[0]
    assert fixed.waveform_spread < 4e-3
    assert fixed.impulse_spread < 1e-4


def test_a_duration_that_depends_on_speed_does_not(series):
    """Equation (6) with the median S_w and Hertz contacts need time scaled as well."""
    for one in series[1:]:
        assert one.waveform_spread > 0.3
        assert one.impulse_spread > 0.1
    assert series[1].shape_spread < 4e-3
    # 20 samples of a Hertz contact: averages over 1/20 of the pulse
    assert series[2].shape_spread < 0.15


def test_steel_on_acrylic_lasts_half_a_millisecond(series):
    """Johnson, Contact Mechanics: T = 2.943 (5 m / (4 K))^.4 v^-.2, K = 4/3 E* R^.5."""
    record = series[2].records[-1]
    stars = (1 - 0.3**2) / 2e11 + (1 - 0.37**2) / 3.2e9
    K = 4 / 3 / stars * math.sqrt(0.015)
    speed = math.sqrt(2 * 9.81 * record.height)
    T = 2.9432 * (5 * 0.115 / (4 * K)) ** 0.4 * speed**-0.2
    # W is from the centre of impulse of the waveform with E = .95
    assert record.impact.duration == pytest.approx(T * (1 + RESTITUTION) / 2, rel=0.02)
    assert equivalent_young() == pytest.approx(2 * 0.91 / stars)


def test_the_median_width_is_that_of_table_three():
    assert median_width() == pytest.approx((0.635 + 1.759) / 2)


def test_the_command_draws_both_figures(tmp_path):
    pytest.importorskip("matplotlib")
    arguments = ["force-sensor", "--out", str(tmp_path), "--json", "-"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    for name in ("waveforms", "impulses"):
        assert (tmp_path / f"force_sensor_{name}.png").stat().st_size > 30_000


@pytest.mark.parametrize("height", [0.0, 0.3, float("nan")])
def test_a_height_that_cannot_be_is_refused(height):
    with pytest.raises(cradle_models.ModelValueError, match="allowed: above 0"):
        cradle_models.force_sensor(heights=[height])


def test_the_ball_touches_the_plate_where_it_hangs():
    """The front of the plate is one radius from the centre of the hanging ball."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(cradle_models.force_sensor())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ball, plate = data.geom("ball_1").xpos, data.geom("plate").xpos
    assert plate[0] - 0.0025 - ball[0] == pytest.approx(0.015, abs=1e-15)
