"""Rows are those of one sweep: what is of another is neither mixed nor thrown away."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

import pytest

import mujoco_impact
from mujoco_impact.errors import ConfigError, SweepError


def swept(given: dict[str, Any] | Path, out: Path | None = None, **options: Any):
    return mujoco_impact.sweep(given, out, processes=1, **options)


def contents(out: Path) -> dict[str, bytes]:
    """Bytes of a file, or of the files of a folder."""
    if out.is_file():
        return {"": out.read_bytes()}
    return {file.name: file.read_bytes() for file in out.iterdir()}


def test_rows_of_another_specification_are_refused(given, tmp_path):
    out = tmp_path / "rows.csv"
    swept(given, out)
    before = out.read_bytes()
    for change, message in (
        ({"duration": 0.05}, "duration was 0.04, and is 0.05"),
        ({"record": ["impacts"]}, "record was .'velocity_error'"),
        ({"timestep": 0.001}, "timestep was not given, and is 0.001"),
        ({"grid": {"mass": {"right": [0.1]}}}, r"grid.mass.right was \[0.1, 0.3\]"),
    ):
        with pytest.raises(SweepError, match=message):
            swept({**given, **change}, out)
    model = Path(given["scene"]["model"])
    model.write_text(model.read_text().replace('size=".01"', 'size=".011"'))
    with pytest.raises(SweepError, match=r"the file .*two_balls\.xml was"):
        swept(given, out)
    assert out.read_bytes() == before
    # unless they are thrown away
    swept({**given, "record": ["impacts"]}, out, restart=True)
    assert "impacts" in out.read_text()


def test_a_plot_may_change_beside_the_rows(given, tmp_path):
    swept(given, tmp_path / "rows.csv")
    swept({**given, "plot": {"title": "another"}}, tmp_path / "rows.csv")


def test_rows_that_no_sweep_tells_of_are_refused(given, tmp_path):
    out = tmp_path / "rows.csv"
    swept(given, out)
    (tmp_path / "rows.csv.sweep.json").unlink()
    for restart in (False, True):
        with pytest.raises(SweepError, match="does not tell what it is") as caught:
            swept(given, out, restart=restart)
        assert "--restart" not in str(caught.value)
    assert len(out.read_text().splitlines()) == 5


def test_of_a_folder_only_rows_that_a_sweep_wrote_are_thrown_away(given, tmp_path):
    pytest.importorskip("pyarrow")
    out = tmp_path / "data.parquet"
    out.mkdir()
    notes = out / "notes.txt"
    notes.write_text("made by hand")
    with pytest.raises(SweepError, match="does not tell what it is"):
        swept(given, out, restart=True)
    assert notes.read_text() == "made by hand"
    shutil.rmtree(out)
    swept(given, out)
    whole = contents(out)
    (out / ".0123456789ab.parquet").write_bytes(b"PAR1")
    notes.write_text("made by hand")
    with pytest.raises(SweepError, match=r"notes\.txt is no file of rows"):
        swept(given, out, restart=True)
    assert whole.items() <= contents(out).items()
    notes.unlink()
    swept({**given, "record": ["impacts"]}, out, restart=True)
    assert contents(out).keys() == whole.keys()
    assert contents(out) != whole


def test_rows_stay_if_the_way_to_run_is_not_valid(given, tmp_path):
    out = tmp_path / "rows.csv"
    swept(given, out)
    whole = out.read_bytes()
    for options, message in (
        ({"processes": 0}, "processes = 0: must be >= 1"),
        ({"executor": 3}, "executor = 3: allowed: anything with the interface"),
    ):
        with pytest.raises(ConfigError, match=message):
            mujoco_impact.sweep(given, out, restart=True, **options)
    assert out.read_bytes() == whole


TETRAHEDRON = """
v 0 0 0
v .01 0 0
v 0 .01 0
v 0 0 .01
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""


def test_rows_of_a_mesh_that_was_another_are_refused(scene, tmp_path):
    """The model file is the same: only a file that it names has changed."""
    mesh = tmp_path / "thing.obj"
    mesh.write_text(TETRAHEDRON)
    text = scene.read_text()
    text = text.replace(
        "<worldbody>",
        '<asset><mesh name="thing" file="thing.obj"/></asset><worldbody>'
        '<geom type="mesh" mesh="thing" pos="0 0 1"/>',
    )
    scene.write_text(text)
    (tmp_path / "study.toml").write_text(
        'duration = 0.04\nrecord = "impacts"\nscene.model = "two_balls.xml"\n'
    )
    # a study may be moved
    folder = tmp_path / "moved"
    folder.mkdir()
    out = folder / "rows.csv"
    swept(tmp_path / "study.toml", out)
    for file in (scene, mesh, tmp_path / "study.toml"):
        shutil.move(file, folder)
    study, mesh = folder / "study.toml", folder / mesh.name
    assert len(swept(study, out).rows) == 1
    mesh.write_text(TETRAHEDRON.replace(".01", ".011"))
    # MuJoCo keeps meshes, and takes files of one second for the same
    os.utime(mesh, (0, 0))
    with pytest.raises(SweepError, match=r"the file two_balls\.xml was"):
        swept(study, out)


def test_rows_that_were_changed_are_refused(given, tmp_path):
    out = tmp_path / "rows.csv"
    swept(given, out)
    text = out.read_text()
    for changed, message in (
        (text.replace("0.3", "0.4"), "row 3 of .* is not of this sweep"),
        (text + text.splitlines()[-1] + "\n", "row 5 of .* is not of this sweep"),
        (text.replace("impulse", "momentum"), "does not hold rows of this sweep"),
        (text + "4,x\n", "does not hold rows of this sweep"),
    ):
        out.write_text(changed)
        with pytest.raises(SweepError, match=message):
            swept(given, out)


def test_two_sweeps_do_not_write_the_same_rows(given, tmp_path):
    pytest.importorskip("fcntl")

    def again(done: int, _: int) -> None:
        if done == 1:
            with pytest.raises(SweepError, match="another sweep is writing"):
                swept(given, tmp_path / "rows.csv")

    assert len(swept(given, tmp_path / "rows.csv", progress=again).rows) == 4
