"""The machine and the versions of a run, without names of hosts or folders."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from collections.abc import Iterable
from pathlib import Path

import mujoco
import numpy as np

from mujoco_impact_lab.bench.methods import MethodFamily


def machine() -> dict[str, str | int]:
    """Returns processor, number of its cores that may be used, and system."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 0
    return {
        "processor": _processor(),
        "cores": cores or os.cpu_count() or 1,
        "architecture": platform.machine(),
        "system": platform.system(),
    }


def versions(families: Iterable[MethodFamily]) -> dict[str, str]:
    """Returns the versions of all that was measured."""
    found = {
        "mujoco-impact": importlib.metadata.version("mujoco-impact"),
        "mujoco": mujoco.mj_versionString(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": importlib.metadata.version("scipy"),
    }
    found |= {family.name: family.version for family in families if family.version}
    return found


def _processor() -> str:
    """Returns the model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    for line in lines:
        name, _, value = line.partition(":")
        if name.strip() == "model name":
            return value.strip()
    return platform.processor() or platform.machine()
