"""The table of materials is that of the package."""

import re
from pathlib import Path

import mujoco_impact

PAGE = Path(__file__).parents[2] / "docs/materials.md"


def test_the_table_of_materials_has_the_numbers_that_ship():
    text = PAGE.read_text(encoding="utf-8")
    section = text.split("## Materials that ship")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)` \|(.*?)\|(.*?)\|(.*?)\|(.*?)\|", section, re.M)
    shown = {
        name: tuple(float(number) if number.strip() else None for number in numbers)
        for name, *numbers in rows
    }
    assert shown == {
        name: (one.restitution, one.young, one.poisson, one.friction)
        for name, one in mujoco_impact.MATERIALS.items()
    }
