"""The library of the benchmark, built once."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mujoco_impact_lab.bench.library import LIBRARY_VARIABLE

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def library_path() -> str:
    """Path of the library; a build takes ten seconds, the next ones none."""
    built = subprocess.run(
        [ROOT / "scripts/bench-build", Path(sys.executable).parent,
         "mujoco_impact_bench"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert built.returncode == 0, built.stderr
    return built.stdout.strip()


@pytest.fixture
def library(library_path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The benchmark finds the library."""
    monkeypatch.setenv(LIBRARY_VARIABLE, library_path)
