"""Files of shots: what is written is read, what is wrong is named by its place."""

from pathlib import Path

import numpy as np
import pytest

import cradle_models
from mujoco_impact.calibration import (
    Camera,
    Shots,
    hertz_truth,
    read_shots,
    synthetic_shots,
    write_shots,
)
from mujoco_impact.calibration.shots_file import columns
from mujoco_impact.errors import ShotsError

BALLS = cradle_models.balls("BAB")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    shots = synthetic_shots(BALLS, count=4, camera=Camera())
    return write_shots(shots, tmp_path / "shots.csv")


def edited(file: Path, line: int, column: str, text: str) -> Path:
    """The file with one cell replaced; line 1 is that of the headings."""
    rows = [row.split(",") for row in file.read_text().splitlines()]
    rows[line - 1][[h.split(" ")[0] for h in rows[0]].index(column)] = text
    file.write_text("\n".join(",".join(row) for row in rows))
    return file


def test_shots_survive_their_file_to_the_last_bit(file):
    shots = synthetic_shots(BALLS, count=4, camera=Camera())
    again = read_shots(file)
    for name in ("masses", "before", "after", "directions"):
        np.testing.assert_array_equal(getattr(again, name), getattr(shots, name))


def test_the_order_of_columns_does_not_matter(file):
    rows = [line.split(",") for line in file.read_text().splitlines()]
    turned = "\n".join(",".join(reversed(row)) for row in rows)
    shots = read_shots(file)
    file.write_text(turned + "\n")
    np.testing.assert_array_equal(read_shots(file).after, shots.after)


@pytest.mark.parametrize(
    ("line", "column", "text", "words"),
    [
        (3, "v2x_after", "nan", ("line 3", "'v2x_after'", "'nan'")),
        (2, "v1z_before", "fast", ("line 2", "'v1z_before'", "'fast'")),
        (5, "n2z", "inf", ("line 5", "'n2z'", "'inf'")),
        (4, "m2", "0.23", ("line 4", "'m2'", "0.23", "0.115")),
        (3, "m1", "", ("line 3", "'m1'", "''")),
        (4, "n1z", "0.5", ("line 4", "contact 1", "length")),
        (3, "v1z_before", "-0.4", ("line 3", "ball 1", "closing speed")),
        (1, "v1x_before", "v1x_before [mm/s]", ("line 1", "[mm/s]", "[m/s]")),
        (1, "v1x_before", "v1x_before", ("line 1", "no unit", "[m/s]")),
        (1, "v1x_before", "v1x_begin [m/s]", ("line 1", "v1x_before [m/s]", "missing")),
        (1, "shot", "speed [m/s]", ("line 1", "'speed'", "unknown")),
        (1, "v2z_after", "v2y_after [m/s]", ("line 1", "v2y_after", "twice")),
    ],
)
def test_what_is_wrong_is_named_by_line_and_column(file, line, column, text, words):
    with pytest.raises(ShotsError) as caught:
        read_shots(edited(file, line, column, text))
    for word in (str(file), *words):
        assert word in str(caught.value)


def test_a_row_that_is_too_short_is_named(file):
    lines = file.read_text().splitlines()
    lines[2] = lines[2].rsplit(",", 1)[0]
    file.write_text("\n".join(lines))
    with pytest.raises(ShotsError, match="line 3: 27 cells; the headings have 28"):
        read_shots(file)


@pytest.mark.parametrize("text", ["", "shot,m1 [kg]\n1,0.1\n", "a [b\n"])
def test_a_file_without_shots_is_refused(tmp_path, text):
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(ShotsError, match=r"bad\.csv"):
        read_shots(tmp_path / "bad.csv")


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(ShotsError, match="No such file"):
        read_shots(tmp_path / "none.csv")


def test_every_column_has_a_unit():
    assert len(columns(3)) == 3 + 2 * 9 + 2 * 3
    assert set(columns(2).values()) == {"kg", "m/s", "-"}


def test_exact_shots_conserve_momentum_and_follow_the_hertz_impact():
    """Published first impact of two A behind a B: .161981 .316976 1.359062 (e = 1)."""
    shots = synthetic_shots(cradle_models.balls("BAA"), count=3, speeds=(0.4, 0.8))
    assert np.abs(shots.imbalance).max() < 1e-12  # rounding
    ratio = shots.after[:, :, 2] / shots.before[:, :1, 2]
    expected = [0.161981, 0.316976, 1.359062]
    np.testing.assert_allclose(ratio, [expected] * 3, rtol=0, atol=1e-6)  # as printed
    share = hertz_truth(cradle_models.balls("BAA")).share
    np.testing.assert_allclose(share[1], expected[2] / 2, atol=1e-6)  # m_A / m_B


def test_the_camera_sees_velocities_with_the_error_of_its_fit():
    """Line through n frames: sd = error * rate * sqrt(12 / (n (n^2 - 1)))."""
    camera = Camera(error=5e-5, frames=8)
    shots = synthetic_shots(BALLS, count=2000, camera=camera, seed=1)
    exact = synthetic_shots(BALLS, count=2000)
    sd = 5e-5 * 500 * np.sqrt(12 / (8 * 63))
    for name in ("before", "after"):
        error = getattr(shots, name) - getattr(exact, name)
        # 18000 samples: their spread is known to 0.5 %; the swing bends a line by 0.3 %
        assert error.std() == pytest.approx(sd, rel=0.03)
        assert abs(error.mean()) < 4 * sd / np.sqrt(error.size)


def test_shots_that_cannot_be_are_refused():
    good = synthetic_shots(BALLS, count=2)
    with pytest.raises(ShotsError, match="directions of shape"):
        Shots(good.masses, good.before, good.after, good.directions[:, :1])
    with pytest.raises(ShotsError, match="velocities"):
        Shots(good.masses, good.before[:, :2], good.after, good.directions)
    with pytest.raises(ShotsError, match="masses"):
        Shots(-good.masses, good.before, good.after, good.directions)
    with pytest.raises(ShotsError, match="no shots"):
        good.subset([])
    with pytest.raises(ShotsError, match="slowest <= fastest"):
        synthetic_shots(BALLS, speeds=(0.5, 0.1))
    with pytest.raises(ShotsError, match="frames = 1"):
        Camera(frames=1)
