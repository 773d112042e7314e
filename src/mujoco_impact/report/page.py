"""The page of a report: facts, tables, plots and videos in one file."""

from __future__ import annotations

import base64
import dataclasses
import importlib.util
import os
import platform
from collections.abc import Mapping
from html import escape
from importlib import metadata
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mujoco_impact.errors import MissingExtraError
from mujoco_impact.extras import install_hint
from mujoco_impact.files import check_writable, write_text
from mujoco_impact.text import printable

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; color: #212529; background: #fff;
  max-width: 1180px; margin: 0 auto; padding: 1rem 1.5rem 3rem; }
h1 { font-size: 1.6rem; margin: .5rem 0; }
h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; }
code { font: .9em ui-monospace, monospace; background: #f1f3f5; padding: .15em .35em;
  border-radius: 4px; overflow-wrap: anywhere; }
table { border-collapse: collapse; font-size: .9rem; margin: .5rem 0; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th { text-align: right; vertical-align: bottom; white-space: pre-line;
  border-bottom: 2px solid #adb5bd; }
td { text-align: right; border-bottom: 1px solid #e9ecef;
  font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; }
th.text, td.text { text-align: left; }
tr.ours td { font-weight: 700; background: #fff5f5; }
.wide { overflow-x: auto; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1.2rem;
  font-size: .9rem; }
dt { color: #6c757d; } dd { margin: 0; overflow-wrap: anywhere; }
video { max-width: 100%; border: 1px solid #dee2e6; border-radius: 6px; }
p.note { color: #495057; font-size: .9rem; }
"""


@dataclasses.dataclass(frozen=True, eq=False)
class Section:
    """A part of a page.

    Attributes:
        heading: Its title.
        html: Tables and text, as HTML.
        plot: A figure or layout of bokeh below, or None.
        video: A video file (.mp4) to hold, or None.
    """

    heading: str
    html: str = ""
    plot: Any = None
    video: Path | None = None


@dataclasses.dataclass(frozen=True, eq=False)
class Page:
    """A report.

    Attributes:
        title: Its title.
        command: The command that made it.
        facts: What was run: names and values.
        sections: Its parts.
        notes: Sentences above them.
    """

    title: str
    command: str
    facts: Mapping[str, str]
    sections: tuple[Section, ...]
    notes: tuple[str, ...] = ()


def check_report(path: str | os.PathLike[str] | None) -> None:
    """Raises an error if a report could not be written, before anything is computed.

    Args:
        path: The file; None if no report is asked for.

    Raises:
        MissingExtraError: If bokeh is missing.
        OSError: If the file cannot be written.
    """
    if path is None:
        return
    check_writable(path)
    if importlib.util.find_spec("bokeh") is None:
        raise MissingExtraError(f"reports need bokeh: run {install_hint('report')}")


def write_page(page: Page, path: str | os.PathLike[str]) -> Path:
    """Writes a report that opens from disk, without a network.

    Returns:
        The path written.
    """
    from bokeh.embed import components
    from bokeh.resources import Resources

    plots = [one.plot for one in page.sections if one.plot is not None]
    script, places = components(tuple(plots)) if plots else ("", ())
    # the plots need the core of bokeh alone: 1.3 MB instead of 3.8
    library = Resources(mode="inline", components=["bokeh"]).render_js()
    waiting = iter(places)
    parts = [
        _section(one, next(waiting) if one.plot is not None else "")
        for one in page.sections
    ]
    title = escape(printable(page.title))
    text = f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{STYLE}</style>
{library if plots else ""}
</head>
<body>
<h1>{title}</h1>
<p><code>{escape(printable(page.command))}</code></p>
{"".join(f'<p class="note">{escape(printable(note))}</p>' for note in page.notes)}
{"".join(parts)}
<h2>What it was made of</h2>
{_facts({**page.facts, **versions()})}
{script}
</body>
</html>
"""
    write_text(path, text)
    return Path(path)


def versions() -> dict[str, str]:
    """Returns the versions that a result depends on."""
    return {
        "mujoco-impact": metadata.version("mujoco-impact"),
        "MuJoCo": mujoco.mj_versionString(),
        "Python": platform.python_version(),
        "NumPy": np.__version__,
        "machine": f"{platform.system()} {platform.machine()}",
    }


def _section(section: Section, place: str) -> str:
    """Returns a section as HTML."""
    text = f"<section><h2>{escape(printable(section.heading))}</h2>{section.html}"
    if section.video is not None:
        content = base64.b64encode(section.video.read_bytes()).decode("ascii")
        source = f'src="data:video/mp4;base64,{content}"'
        text += f"<video controls loop muted playsinline {source}></video>"
    return f"{text}{place}</section>\n"


def _facts(facts: Mapping[str, str]) -> str:
    """Returns names and values as a list."""
    rows = "".join(
        f"<dt>{escape(printable(name))}</dt><dd>{escape(printable(value))}</dd>"
        for name, value in facts.items()
    )
    return f"<dl>{rows}</dl>"
