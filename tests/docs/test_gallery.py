"""The gallery: scenes, each with its picture, its code and its MJCF."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

from gallery_scenes import SCENES  # noqa: E402

PAGE = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
PICTURES = ROOT / "docs/images/gallery"
LARGEST = 3_000_000  # bytes: what a clone may carry of it


def test_every_scene_has_a_picture_and_there_is_no_other():
    assert {file.stem for file in PICTURES.iterdir()} == {one.name for one in SCENES}
    assert sum(file.stat().st_size for file in PICTURES.iterdir()) < LARGEST


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_the_page_is_that_of_scripts_gallery(scene):
    """The code is run by test_snippets; here it is that of the script."""
    _, section = PAGE.split(f"## {scene.title}\n", 1)
    section = section.split("\n## ")[0]
    assert f"images/gallery/{scene.name}.webp" in section
    assert scene.text in section
    assert f"```python\n{scene.code.strip()}\n```" in section
    file = ROOT / "docs/gallery" / f"{scene.name}.xml"
    shown = re.findall(r"```xml\n(.*?)```", section, re.DOTALL)
    assert shown == ([file.read_text(encoding="utf-8")] if file.exists() else [])
