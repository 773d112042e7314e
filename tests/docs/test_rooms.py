# SPDX-License-Identifier: Apache-2.0
"""The rooms of the engine stand in one order, told in CONTRIBUTING.md."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
ENGINE = ROOT / "plugin" / "engine"
# the path of a step, which every room serves and none includes
TOP = {"step", "commit", "plugin"}


def rooms() -> list[str]:
    """Returns the rooms in the order of the table."""
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = page.split("### Rooms of the engine")[1].split("\n## ")[0]
    return re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)


def test_the_table_lists_every_room() -> None:
    assert sorted(rooms()) == sorted(
        folder.name for folder in ENGINE.iterdir() if folder.is_dir()
    )
    assert {file.stem for file in ENGINE.glob("*.cc")} == TOP


def includes(file: Path) -> list[str]:
    """Returns what a source includes of the engine, such as "path/motion"."""
    text = file.read_text(encoding="utf-8")
    return re.findall(r'#include "engine/([\w/]+)\.h"', text)


def test_a_room_includes_no_room_below_it() -> None:
    order = {room: i for i, room in enumerate(rooms())}
    sources = [file for room in order for file in (ENGINE / room).iterdir()]
    upward = [
        f"{file.relative_to(ENGINE)} includes {name}"
        for file in sources
        for name in includes(file)
        if "/" not in name or order[name.split("/")[0]] > order[file.parent.name]
    ]
    assert len(sources) > 2 * len(order)
    assert upward == []


def test_only_the_step_knows_of_pulses_that_last() -> None:
    """The default path is readable, and right, without the room of lasting pulses."""
    users = {
        file.parent.name
        for file in ENGINE.rglob("*.*")
        if '#include "engine/pulses/' in file.read_text(encoding="utf-8")
    }
    assert users <= {"pulses", "engine"}


def test_the_walk_with_one_contact_goes_through_ten_files_at_most() -> None:
    """They are there, and what the page names elsewhere is, too."""
    page = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    walk = page.split("## A walk with one contact")[1].split("\n## ")[0]
    files = re.findall(r"^\| \d+ \| `([\w/.]+)` \|", walk, re.MULTILINE)
    assert 5 < len(files) <= 10
    named = re.findall(r"`([\w/]+\.(?:cc|h))`", page)
    missing = [
        name
        for name in named
        if not any((top / name).exists() for top in (ENGINE, ENGINE.parent, ROOT))
    ]
    assert missing == []
