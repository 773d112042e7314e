"""Counting instructions: what callgrind prints is read, its absence is named."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest

from mujoco_impact_lab.bench.instructions import InstructionsError, count_instructions

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
