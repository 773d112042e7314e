"""Storing trajectories."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mujoco_impact import Impact, Trajectory
from mujoco_impact.errors import TrajectoryError

IMPACTS = (
    Impact(
        *(0.1, ("left", "right"), 0.2, 1.0, 3141.6, 1e-4, 0.9, 3678.0),
        *(1.5, (0.1, 0.2, 0.3), (0.0, 0.6, 0.8), (0.05, 0.0, 0.0)),
    ),
    Impact(
        *(0.3, ("größe", "geom 3"), 1 / 3, 0.5, 10.0, 7.5e-3, 1.0, 10.0),
        *(0.0, (1 / 3, 0.0, -1.0), (1.0, 0.0, 0.0)),
    ),
)


def trajectory(impacts: tuple[Impact, ...]) -> Trajectory:
    """Returns a trajectory of arbitrary numbers."""
    random = np.random.default_rng(1)
    return Trajectory(
        time=np.arange(4) * 0.1,
        qpos=random.normal(size=(4, 7)),
        qvel=random.normal(size=(4, 6)),
        energy=random.normal(size=(4, 2)),
        impacts=impacts,
        timestep=0.1,
        integrator="RK4",
        mujoco_version="3.17.0",
        missed_impacts=2,
    )


@pytest.mark.parametrize("impacts", [IMPACTS, ()])
def test_saving_and_loading_loses_nothing(
    tmp_path: Path, impacts: tuple[Impact, ...]
) -> None:
    """Arrays bit for bit, impacts field by field, metadata."""
    before = trajectory(impacts)
    after = Trajectory.load(before.save(tmp_path / "run"))
    for name in ("time", "qpos", "qvel", "energy"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name))
    assert after.impacts == impacts
    for name in ("timestep", "integrator", "mujoco_version", "missed_impacts"):
        assert getattr(after, name) == getattr(before, name)


def test_file_gets_the_ending_that_numpy_reads(tmp_path: Path) -> None:
    """A dot in the name is not taken for an ending."""
    assert trajectory(()).save(tmp_path / "v0.5").name == "v0.5.npz"
    assert trajectory(()).save(tmp_path / "run.npz").name == "run.npz"


def test_file_holds_no_pickle(tmp_path: Path) -> None:
    """So that reading a file from elsewhere runs no code."""
    path = trajectory(IMPACTS).save(tmp_path / "run")
    with np.load(path, allow_pickle=False) as file:
        assert all(file[name].dtype != object for name in file.files)


def test_total_energy_is_the_sum() -> None:
    """Potential plus kinetic."""
    one = trajectory(())
    np.testing.assert_array_equal(one.total_energy, one.energy[:, 0] + one.energy[:, 1])


def test_wrong_files_are_refused(tmp_path: Path) -> None:
    """With the reason, never with an error of another library."""
    with pytest.raises(TrajectoryError, match="no trajectory file"):
        Trajectory.load(tmp_path / "none.npz")
    text = tmp_path / "text.npz"
    text.write_text("not a zip file")
    with pytest.raises(TrajectoryError, match="not a trajectory file"):
        Trajectory.load(text)
    array = tmp_path / "array.npy"
    np.save(array, np.zeros(3))
    with pytest.raises(TrajectoryError, match="not a trajectory file"):
        Trajectory.load(array)
    other = tmp_path / "other.npz"
    np.savez(other, layout_version=99)
    with pytest.raises(TrajectoryError, match="layout version 99"):
        Trajectory.load(other)
    with pytest.raises(TrajectoryError, match="cannot write"):
        trajectory(()).save(tmp_path / "no" / "such" / "folder")
