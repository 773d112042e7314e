"""What MkDocs does not do by itself for the documentation site; a hook of mkdocs.yml.

* Pages outside docs/, such as README.md, become pages of the site.
* Links are written for the repository. A link to a page becomes one of the site; a
  link to a file that the site does not have becomes the text of the link.
* Formulas become drawings, so that no page needs a script or a font from elsewhere.
* `<!-- command line -->` becomes the reference of the commands.
"""

from __future__ import annotations

import html
import posixpath
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from mujoco_impact.cli import app

with warnings.catch_warnings():
    # it calls what Python has deprecated
    warnings.simplefilter("ignore", DeprecationWarning)
    import ziamath

ziamath.config.svg2 = False  # without shared symbols, whose names would clash

ROOT = Path(__file__).parents[1]
OUTSIDE = {
    "index.md": "README.md",
    "plugin.md": "plugin/README.md",
    "models.md": "cradle_models/README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
}
"""Pages of the site that are files of the repository outside docs/."""

COMMAND_LINE = "<!-- command line -->"
CODE = re.compile(r"(^```.*?^```$|`[^`\n]+`)", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
WORKER = re.compile(r'src="[^"]*/iframe-worker/shim"')
EM = 20.0
"""Size at which formulas are drawn, before they are given that of the text."""

FORMULA = re.compile(
    r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL
)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that lie outside docs/."""
    for uri, source in OUTSIDE.items():
        files.append(File.generated(config, uri, abs_src_path=str(ROOT / source)))
    return files


def on_page_markdown(markdown: str, *, page: Page, files: Files, **_: Any) -> str:
    """Makes the links of a page those of the site, and writes the command line."""
    uri = page.file.src_uri
    if uri == "index.md":
        page.meta["hide"] = ["navigation"]
    text = outside_code(
        markdown,
        lambda part: LINK.sub(lambda link: site_link(link, uri, files), part),
    )
    if COMMAND_LINE in text:
        text = text.replace(COMMAND_LINE, command_line())
    return text


def on_page_content(content: str, **_: Any) -> str:
    """Draws the formulas."""
    return FORMULA.sub(
        lambda found: drawn(html.unescape(found[2]), block=found[1] == "div"), content
    )


def drawn(tex: str, *, block: bool) -> str:
    """Returns a formula as SVG that has the size and the colour of the text."""
    formula = ziamath.Latex(tex, size=EM, color="currentColor", inline=not block)
    svg = formula.svgxml()
    _, top, width, height = (float(n) / EM for n in svg.get("viewBox").split())
    svg.set("width", f"{width:.3f}em")
    svg.set("height", f"{height:.3f}em")
    svg.set("style", f"vertical-align: {-(top + height):.3f}em")
    svg.set("role", "img")
    svg.set("aria-label", tex)
    text = ElementTree.tostring(svg, encoding="unicode")
    return f'<div class="formula">{text}</div>' if block else text


def on_post_page(output: str, *, page: Page, **_: Any) -> str:
    """Takes the script that searches from disk from here, not from elsewhere."""
    here = posixpath.dirname(page.file.dest_uri)
    script = posixpath.relpath("assets/worker_on_disk.js", here or ".")
    return WORKER.sub(f'src="{script}"', output)


def outside_code(text: str, change: Callable[[str], str]) -> str:
    """Changes what is not code."""
    parts = CODE.split(text)
    return "".join(
        part if index % 2 else change(part) for index, part in enumerate(parts)
    )


def site_link(link: re.Match[str], uri: str, files: Files) -> str:
    """Returns a link of the repository as it is on the site.

    Raises:
        FileNotFoundError: If it leads to nothing.
    """
    image, text, target, anchor = link.groups(default="")
    if target.startswith(("http://", "https://", "mailto:")):
        return link[0]
    source = OUTSIDE.get(uri, f"docs/{uri}")
    path = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
    if not (ROOT / path).exists():
        raise FileNotFoundError(f"{source}: there is no {target}")
    if (ROOT / path).is_dir():
        path = posixpath.join(path, "README.md")
    place = {page: place for place, page in OUTSIDE.items()}.get(path)
    if place is None:
        place = posixpath.relpath(path, "docs")
    if files.get_file_from_path(place) is None:
        return text
    here = posixpath.dirname(uri)
    return f"{image}[{text}]({posixpath.relpath(place, here or '.')}{anchor})"


def command_line() -> str:
    """Returns a section for each command: what it does, arguments, options."""
    group = typer.main.get_command(app)
    context = typer.Context(group, info_name="mujoco-impact")
    return "\n\n".join(
        command_section(command, typer.Context(command, info_name=name, parent=context))
        for name, command in group.commands.items()
    )


def command_section(command: Any, context: typer.Context) -> str:
    """Returns the section of one command."""
    usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    rows = [
        (parameter, *record)
        for parameter in command.get_params(context)
        if (record := parameter.get_help_record(context)) is not None
        and parameter.name != "help"
    ]
    table = "\n".join(f"| `{name}` | {cell(text)} |" for _, name, text in rows)
    heading = f"## {context.info_name}\n\n{command.help}\n\n```text\n{usage}\n```"
    if not rows:
        return heading
    return f"{heading}\n\n| argument or option | meaning |\n| --- | --- |\n{table}"


def cell(text: str) -> str:
    """Returns text that may stand in a cell of a table."""
    line = " ".join(text.split()).replace("|", "\\|")
    # "[s] [default: 2]" is no link
    return outside_code(line, lambda part: part.replace("[", "\\["))
