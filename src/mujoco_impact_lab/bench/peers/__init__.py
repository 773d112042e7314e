"""Other engines that install from PyPI, on the same rows.

Each module makes one method. They are the dependency group `peers`; an engine that is
not installed is reported as missing. Except for Exudyn they are stepped by a Python
loop, which their run times include: it is how they are used.
"""

from __future__ import annotations

from mujoco_impact_lab.bench.methods import MethodFamily
from mujoco_impact_lab.bench.peers import (
    bullet_engine,
    dart_engine,
    exudyn_engine,
    pymunk_engine,
)


def families() -> tuple[MethodFamily, ...]:
    """Returns the other engines as methods."""
    modules = (exudyn_engine, pymunk_engine, bullet_engine, dart_engine)
    return tuple(module.family() for module in modules)
