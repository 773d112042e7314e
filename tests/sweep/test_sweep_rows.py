"""What a row says of its case, and that rows are the same however they came to be."""

from __future__ import annotations

import csv
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import mujoco_impact
from mujoco_impact.errors import (
    ConfigError,
    SceneError,
    SweepError,
    SweepInterrupted,
)
from mujoco_impact.sweeping import rows_file

AFTER = "velocity_after.right.x"


def swept(given: dict[str, Any], out: Path | None = None, **options: Any):
    return mujoco_impact.sweep(given, out, processes=1, **options)


def lines(file: Path) -> list[dict[str, str]]:
    with file.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_rows_are_the_closed_form_of_two_balls(given, tmp_path):
    """v2 = (1 + e) m1 / (m1 + m2) v, P = m2 v2; to rounding, as the impact is."""
    found = swept(given, tmp_path / "rows.csv")
    assert len(found.rows) == 4
    assert [row["case"] for row in found.rows] == [0, 1, 2, 3]
    for row in found.rows:
        mass, e = row["mass.right"], row["attach.restitution"]
        speed = (1 + e) * 0.1 / (0.1 + mass)
        assert row[AFTER] == pytest.approx(speed, rel=1e-9)
        assert row["impulse"] == pytest.approx(mass * speed, rel=1e-9)
        assert row["velocity_error"] < 1e-9
        assert row["error"] is None
    written = lines(tmp_path / "rows.csv")
    assert [float(row[AFTER]) for row in written] == [row[AFTER] for row in found.rows]


def test_every_quantity_and_parameter_is_taken(given):
    given |= {
        "record": [
            *("impact_speed", "velocity_error", "angle_rms", "velocity_rms"),
            *("energy_lost", "energy_change", "impacts", "deepest_overlap", "passed"),
            *("impulse", "impulse.left+right", "velocity_after", "run_time"),
        ],
        "timestep": 0.001,
        "integrator": "RK4",
        "speed_factor": 2.0,
        "qpos": {"x1": -0.01},
        "qvel": {"x2": -1},
        "attach": {"gap": 0.02},
        "grid": {"method": ["mujoco-impact", "MuJoCo damper"]},
    }
    ours, damper = swept(given).rows
    # 1 m/s of the keyframe and 1 m/s against it, both times the factor
    assert ours["impact_speed"] == pytest.approx(4.0, rel=1e-9)
    assert ours["velocity_after.left.x"] == pytest.approx(-2.0, rel=1e-9)
    assert ours[AFTER] == pytest.approx(2.0, rel=1e-9)
    assert ours["impulse"] == ours["impulse.left+right"] == pytest.approx(0.4, rel=1e-9)
    assert ours["impacts"] == damper["impacts"] == 1
    assert ours["energy_lost"] == pytest.approx(0.0, abs=1e-9)
    assert ours["run_time"] > 0
    assert damper["run_time"] > 0
    # MuJoCo's contacts tell no impulse; a row of pendulums it is not
    assert damper["impulse"] is None
    assert ours["angle_rms"] is None
    # under RK4 the damper does not what it does under Euler
    assert damper["velocity_error"] > 1e-2


def test_methods_that_are_tuned_are_tuned_for_what_was_asked():
    """The Hertz-like setting knows one speed; away from it, it is worse."""
    given = {
        "scene": {"builder": "row", "pattern": "AAA"},
        "duration": 0.45,
        "record": "velocity_error",
        "method": "MuJoCo Hertz-like",
        "grid": {"tuned_for": ["itself", 0.1]},
    }
    itself, other = (row["velocity_error"] for row in swept(given).rows)
    assert itself < 1e-2 < other


def test_a_case_that_fails_is_a_row_with_its_error(given, tmp_path):
    given["grid"] = {"attach": {"restitution": [1.0, 1.5, 0.5]}}
    found = swept(given, tmp_path / "rows.csv")
    assert [bool(row["error"]) for row in found.rows] == [False, True, False]
    row = found.rows[1]
    assert row["error"].startswith("ConfigError: the plugin refuses restitution=1.5")
    assert row[AFTER] is None
    assert found.failures == (row,)
    assert lines(tmp_path / "rows.csv")[1]["error"] == row["error"]


def test_a_scene_without_an_impact_fails_and_says_so(given):
    del given["duration"]
    found = swept({**given, "grid": {"duration": [0.04, 0.002]}})
    assert "there is no impact" in found.rows[1]["error"]


def test_what_has_no_reference_says_why(given):
    given |= {"scene": {"builder": "row", "pattern": "AAA"}, "duration": 0.5}
    given |= {"record": ["velocity_error"], "attach": {"restitution": 0.9}, "grid": {}}
    (row,) = swept(given).rows
    assert row["velocity_error"] is None
    assert row["remarks"] == "no Hertz reference: it is elastic, the law is not"


def test_what_does_not_fit_the_scene_is_told_before_anything_runs(given, tmp_path):
    for change, error, message in (
        ({"mass": {"rigt": 1}}, ConfigError, "no geom 'rigt'; did you mean 'right'"),
        ({"qvel": {"x9": 1}}, ConfigError, "no joint 'x9' .available: x1, x2."),
        ({"qpos": {"x1": [1, 2]}}, ConfigError, "numbers the joint needs: 1"),
        (
            {"record": ["impulse.left+rigth"]},
            ConfigError,
            "'impulse.left.rigth': the scene has no geom 'rigth'; did you mean 'right'",
        ),
        (
            {"record": ["velocity_after.nobody"]},
            ConfigError,
            "no moving body 'nobody' .available: left, right.",
        ),
        ({"keyframe": "shut"}, SceneError, "did you mean 'shot'"),
        ({"scene": {"model": "nothing.xml"}}, SceneError, "no model file"),
    ):
        with pytest.raises(error, match=message):
            swept({**given, "grid": {}, **change}, tmp_path / "rows.csv")
    assert not list(tmp_path.glob("rows*"))


def test_an_impulse_is_0_only_of_a_pair_that_is_there():
    """The first two balls of three meet first; a scene of two has no third."""
    given = {
        "scene": {"builder": "row"},
        "duration": 0.3,
        "record": ["impulse.ball_1+ball_2", "impulse.ball_1+ball_3"],
        "grid": {"scene": {"pattern": ["AAA", "AA"]}},
    }
    three, two = swept(given).rows
    assert three["impulse.ball_1+ball_2"] > 0
    assert three["impulse.ball_1+ball_3"] == 0.0
    assert two["impulse.ball_1+ball_2"] > 0
    assert two["impulse.ball_1+ball_3"] is None
    assert two["error"] is None


def test_repeats_are_rows_of_their_own(given):
    given |= {"repeats": 2, "grid": {"mass": {"right": [0.1, 0.3]}}}
    rows = swept(given).rows
    assert [(row["case"], row["repeat"]) for row in rows] == [
        *((0, 0), (0, 1)),
        *((1, 0), (1, 1)),
    ]
    assert rows[0][AFTER] == rows[1][AFTER]


def test_rows_do_not_depend_on_who_computes_them(given, tmp_path):
    swept(given, tmp_path / "serial.csv")
    mujoco_impact.sweep(given, tmp_path / "processes.csv", processes=2)
    with ThreadPoolExecutor(3) as threads:
        mujoco_impact.sweep(given, tmp_path / "threads.csv", executor=threads)
    serial = (tmp_path / "serial.csv").read_bytes()
    assert (tmp_path / "processes.csv").read_bytes() == serial
    assert (tmp_path / "threads.csv").read_bytes() == serial


def interrupted(given: dict[str, Any], out: Path, after: int) -> None:
    """Begins a sweep and ends it by Ctrl-C after so many rows."""

    def stop(done: int, _: int) -> None:
        if done == after:
            raise KeyboardInterrupt

    with pytest.raises(SweepInterrupted, match=f"after {after} of 4 rows"):
        swept(given, out, progress=stop)


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_an_interrupted_sweep_goes_on_and_ends_the_same(
    given, tmp_path, ending, monkeypatch
):
    if ending == "parquet":
        pytest.importorskip("pyarrow")
    # so that it has several files, the last of one row
    monkeypatch.setattr(rows_file, "PART_ROWS", 3)
    whole, cut = tmp_path / f"whole.{ending}", tmp_path / f"cut.{ending}"
    expected = swept(given, whole).rows
    interrupted(given, cut, 1)
    interrupted(given, cut, 2)
    told: list[tuple[int, int]] = []
    found = swept(given, cut, progress=lambda *numbers: told.append(numbers))
    assert found.rows == expected
    # two cases were left to do
    assert told == [(2, 4), (3, 4), (4, 4)]
    assert contents(cut) == contents(whole)
    # and nothing is left now
    assert swept(given, cut).rows == expected
    assert contents(cut) == contents(whole)


def contents(out: Path) -> dict[str, bytes]:
    """Bytes of a file, or of the files of a folder."""
    if out.is_file():
        return {"": out.read_bytes()}
    return {file.name: file.read_bytes() for file in out.iterdir()}


def test_parquet_has_the_rows_of_csv(given, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    given["grid"]["attach"]["restitution"] = [1.0, 1.5]
    expected = swept(given, tmp_path / "rows.csv").rows
    swept(given, tmp_path / "rows.parquet")
    table = parquet.read_table(tmp_path / "rows.parquet")
    assert tuple(table.to_pylist()) == expected
    types = {field.name: str(field.type) for field in table.schema}
    assert types["case"] == "int64"
    assert types["mass.right"] == types[AFTER] == "double"
    assert types["error"] == "string"


def test_half_a_row_is_cut_off(given, tmp_path):
    """As a full disk or a lost machine leaves it."""
    out = tmp_path / "rows.csv"
    swept(given, out)
    whole = out.read_bytes()
    for left in (len(whole) - 5, whole.index(b"\n") + 9, 4, 0):
        out.write_bytes(whole[:left])
        swept(given, out)
        assert out.read_bytes() == whole


def test_half_a_parquet_file_is_made_anew(given, tmp_path):
    pytest.importorskip("pyarrow")
    out = tmp_path / "rows.parquet"
    swept(given, out)
    whole = contents(out)
    (out / ".0123456789ab.parquet").write_bytes(b"PAR1")
    assert len(swept(given, out).rows) == 4
    assert contents(out) == whole


def test_a_place_that_cannot_be_written_is_told_at_once(given, tmp_path):
    with pytest.raises(SweepError, match=r"must end with .csv or .parquet"):
        swept(given, tmp_path / "rows.txt")
    with pytest.raises(SweepError, match="there is no folder"):
        swept(given, tmp_path / "nowhere" / "rows.csv")


def test_a_specification_is_found_with_its_model_from_any_folder(
    scene, tmp_path, monkeypatch
):
    folder = tmp_path / "study"
    folder.mkdir()
    shutil.move(scene, folder)
    (folder / "sweep.toml").write_text(
        'duration = 0.04\nrecord = "impacts"\nscene.model = "two_balls.xml"\n'
        "grid.attach.restitution = [1, 0.5]\n"
    )
    monkeypatch.chdir(tmp_path)
    found = mujoco_impact.sweep("study/sweep.toml", "rows.csv", processes=1)
    assert [row["impacts"] for row in found.rows] == [1, 1]
    names = sorted(file.name for file in tmp_path.iterdir())
    assert names == ["rows.csv", "rows.csv.sweep.json", "study"]
