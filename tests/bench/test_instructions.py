"""Counting instructions: what callgrind prints is read, its absence is named."""

from __future__ import annotations

import stat
from pathlib import Path

import mujoco
import pytest

from mujoco_impact.runner import load_model
from mujoco_impact_lab.bench.callgrind import InstructionsError
from mujoco_impact_lab.bench.instructions import count_instructions
from mujoco_impact_lab.bench.step_instructions import count_steps, workloads

FAKE = """#!/bin/sh
echo "==1== Collected : 5000" >&2
echo "steps 10 last_velocity 0.88"
"""


@pytest.fixture
def valgrind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A valgrind that counts 5000 instructions whatever it runs."""
    program = tmp_path / "valgrind"
    program.write_text(FAKE)
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    return program


@pytest.mark.usefixtures("valgrind", "library")
def test_counts_of_steps_are_per_step() -> None:
    """With the plugin and without, 100 steps each."""
    workload = workloads()[0]
    count = count_steps(Path("step_workload"), workload)
    assert (count["scene"], count["ratio"]) == ("a ball rests", 1.0)
    assert count["instructions"] == count["without"] == 50


@pytest.mark.usefixtures("library")
def test_every_scene_whose_steps_are_counted_loads_with_the_plugin_and_without() -> (
    None
):
    """What rests is at rest, and its impacts are the plugin's."""
    for workload in workloads():
        ours, without = map(load_model, workload.specs())
        assert (ours.nplugin, without.nplugin) == (1, 0)
        assert ours.nv == without.nv
        if workload.settled:
            data = mujoco.MjData(ours)
            mujoco.mj_step(ours, data, workload.settled)
            assert data.ncon
            # on a slope MuJoCo's contacts creep by 2 mm/s
            assert abs(data.qvel).max() < 3e-3


@pytest.mark.usefixtures("valgrind")
def test_counts_are_per_solve() -> None:
    """3 balls are solved 50 times, in 10 steps of 2 contacts each."""
    count = count_instructions(Path("law_workload"), balls=3)
    assert count["instructions"] == 100
    assert count["steps"] == 10
    assert count["per_step_and_contact"] == 5.0


def test_output_without_a_count_is_an_error(valgrind: Path) -> None:
    """Rather than a count of nothing."""
    valgrind.write_text("#!/bin/sh\necho steps 10\n")
    with pytest.raises(InstructionsError, match="Collected"):
        count_instructions(Path("law_workload"), balls=3)


def test_failing_workload_is_an_error(valgrind: Path) -> None:
    """With what it said."""
    valgrind.write_text("#!/bin/sh\necho out of memory >&2\nexit 1\n")
    with pytest.raises(InstructionsError, match="out of memory"):
        count_instructions(Path("law_workload"), balls=3)


def test_missing_valgrind_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """And how to get it."""
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InstructionsError, match="install"):
        count_instructions(Path("law_workload"), balls=3)
