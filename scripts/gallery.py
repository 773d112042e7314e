"""Draws the gallery and writes its page, for `scripts/gallery`.

`gallery.py [NAME ...]` draws these scenes only, or all. The page has all.
"""

from __future__ import annotations

import contextlib
import io
import re
import sys
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from gallery_scenes import SCENES, Scene

from mujoco_impact.video import Panel, View, write_video

ROOT = Path(__file__).parents[1]
PICTURES = Path("docs/images/gallery")
PAGE = Path("docs/gallery.md")
SIZE = (320, 240)
FPS = 20
BYTES = 3_000_000
"""Most that the pictures may take together."""

HEAD = """# Gallery

{count} scenes, each with the code that runs it, and its MJCF where it has a file. In a
clone of this repository the code works as it stands. Where it makes a `motion`,
`motion.render(spec, "scene.webp")` at its end draws the scene, too: red arrows are
impulses. `scripts/gallery` draws all of them."""

COLUMNS = 5
"""Pictures side by side at the top of the page."""


def main(names: list[str]) -> None:
    """Draws scenes and writes the page."""
    unknown = set(names) - {scene.name for scene in SCENES}
    if unknown:
        raise SystemExit(f"no such scene: {', '.join(sorted(unknown))}")
    parts = []
    for scene in SCENES:
        result, printed = executed(scene)
        if not names or scene.name in names:
            draw(scene, result)
        parts.append(section(scene, printed))
    head = HEAD.format(count=len(SCENES))
    text = "\n\n".join([head, wall(), *parts]) + "\n"
    (ROOT / PAGE).write_text(text, encoding="utf-8")
    print(PAGE)
    taken = sum(file.stat().st_size for file in (ROOT / PICTURES).iterdir())
    print(f"{PICTURES}: {taken / 1e6:.2f} MB")
    if taken > BYTES:
        raise SystemExit(f"the pictures may take {BYTES / 1e6} MB")


def executed(scene: Scene) -> tuple[dict[str, Any], str]:
    """Runs the code of a scene; returns its variables and what it prints."""
    variables: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(scene.code, scene.name, "exec"), variables)
    return variables, printed.getvalue()


def draw(scene: Scene, result: dict[str, Any]) -> None:
    """Draws the picture of a scene."""
    if "motion" in result:
        motion, model = result["motion"], with_eye(result["spec"], scene.eye)
        panel = Panel("", motion.time, motion.qpos, motion.impacts)
    else:
        env = result["env"]
        states = np.array(result["states"])
        panel = Panel("", np.arange(len(states)) * env.control_timestep(), states)
        model = env.physics.model.ptr
    camera = "eye" if scene.eye else None
    view = View(speed=scene.speed, camera=camera, size=SIZE, fps=FPS)
    file = ROOT / PICTURES / f"{scene.name}.webp"
    file.parent.mkdir(parents=True, exist_ok=True)
    write_video(model, [panel], file, view=view)
    print(f"{file.relative_to(ROOT)}: {file.stat().st_size / 1e3:.0f} kB")


def with_eye(spec: mujoco.MjSpec, eye: str) -> mujoco.MjSpec:
    """Adds the camera `eye`: position and two axes."""
    if eye:
        numbers = np.array(eye.split(), dtype=float)
        camera = spec.worldbody.add_camera(name="eye", pos=numbers[:3])
        camera.alt.type = mujoco.mjtOrientation.mjORIENTATION_XYAXES
        camera.alt.xyaxes = numbers[3:]
    return spec


def wall() -> str:
    """Returns a table of all pictures, each a link to its section."""
    cells = [f"[{picture(scene)}](#{slug(scene.title)})" for scene in SCENES]
    rows = [cells[i : i + COLUMNS] for i in range(0, len(cells), COLUMNS)]
    rows.insert(1, ["---"] * COLUMNS)
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def picture(scene: Scene) -> str:
    """Returns the picture of a scene in Markdown."""
    return f"![{scene.title}](images/gallery/{scene.name}.webp)"


def slug(title: str) -> str:
    """Returns the anchor of a heading, as Markdown makes it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def section(scene: Scene, printed: str) -> str:
    """Returns the section of a scene."""
    lines = [
        f"## {scene.title}",
        picture(scene),
        scene.text,
        f"```python\n{scene.code.strip()}\n```",
    ]
    if printed:
        lines.append(f"```text\n{printed.strip()}\n```")
    file = ROOT / "docs" / "gallery" / f"{scene.name}.xml"
    if file.exists():
        lines.append(
            f"<details markdown><summary>MJCF: docs/gallery/{file.name}</summary>\n\n"
            f"```xml\n{file.read_text(encoding='utf-8').strip()}\n```\n\n</details>"
        )
    return "\n\n".join(lines)


if __name__ == "__main__":
    main(sys.argv[1:])
