"""Impacts with friction: the second half of `scripts/bench`.

`scene` says what a scene is; `rack`, `box` and `dominoes` make them, with their truths;
`falling` integrates the dominoes. `methods` has our impacts and MuJoCo's contacts,
`engines` the other engines. `benchmark` makes points of them, with the tables, files
and pictures of the rows of balls.
"""

from mujoco_impact_lab.bench.friction.benchmark import run_friction, write_friction
from mujoco_impact_lab.bench.friction.page import (
    friction_failures,
    friction_table,
    write_page,
)

__all__ = [
    "friction_failures",
    "friction_table",
    "run_friction",
    "write_friction",
    "write_page",
]
