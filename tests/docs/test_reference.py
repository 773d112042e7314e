"""The reference has everything that is public."""

from pathlib import Path

import cradle_models
import mujoco_impact
from mujoco_impact import envs

PAGES = Path(__file__).parents[2] / "docs/api"
# modules of which the pages show the members
OPENED = {"envs", "sensor", "warp"}


def shown() -> set[str]:
    """The objects whose docstrings the pages show."""
    lines = [
        line for page in PAGES.glob("*.md") for line in page.read_text().splitlines()
    ]
    return {line.removeprefix("::: ") for line in lines if line.startswith(":::")}


def test_every_public_name_is_in_it():
    public = set(mujoco_impact.__all__) - {"__version__"} - OPENED
    assert {f"mujoco_impact.{name}" for name in public} | {
        f"mujoco_impact.envs.{name}" for name in envs.__all__
    } <= shown()
    # a module is shown with all of its members
    assert cradle_models.__name__ in shown()
