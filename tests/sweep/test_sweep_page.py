"""The page about sweeps has everything that a specification can have."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

from mujoco_impact.cli.sweep import sweep
from mujoco_impact.sweeping.cases import _DISTRIBUTIONS
from mujoco_impact.sweeping.parameters import SECTIONS, SINGLE, methods
from mujoco_impact.sweeping.quantities import QUANTITIES
from mujoco_impact.sweeping.specification import read_specification, tomllib

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "sweeps.md").read_text(encoding="utf-8")


def test_every_parameter_and_quantity_is_in_it():
    names = {*SINGLE, *SECTIONS, *QUANTITIES, *methods(), *_DISTRIBUTIONS}
    code = " ".join(re.findall(r"`([^`\n]+)`", PAGE))
    assert {name for name in names if name not in code} == set()


def test_the_example_of_the_help_is_a_specification():
    help_text = inspect.getdoc(sweep) or ""
    example = tomllib.loads(help_text.split("```toml\n")[1].split("```")[0])
    assert len(read_specification(example).cases) == 4


def test_the_example_is_the_file():
    """But for comments, and the title of its picture."""
    shown = PAGE.split("```toml\n")[1].split("```")[0]
    example: dict[str, Any] = tomllib.loads(
        (DOCS / "examples" / "impact_speed.toml").read_text(encoding="utf-8")
    )
    del example["plot"]["title"]
    assert tomllib.loads(shown) == example
    assert len(read_specification(example).cases) == 54
