"""What commands need for a report: its options, and how they were called."""

from __future__ import annotations

import contextlib
import shlex
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import mujoco
import typer

from mujoco_impact.errors import ConfigError
from mujoco_impact.starts import Keyframe
from mujoco_impact.video.motion import Panel

HtmlOption = Annotated[
    Path | None,
    typer.Option(
        "--html",
        metavar="FILE",
        help="Report to write: one page with tables and plots that opens from disk.",
    ),
]
VideoOption = Annotated[
    bool, typer.Option("--video", help="With a video in the report of --html.")
]

VIDEO_SIZE = (480, 360)
"""Size of each panel of a video in a report [pixels]."""


def command_line(context: typer.Context) -> str:
    """Returns the command as it was given, options in the order of the help."""
    words = context.command_path.split()
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if source is None or source.name != "COMMANDLINE":
            continue
        value = context.params[name]
        values = value if isinstance(value, list | tuple) else [value]
        if parameter.param_type_name == "argument":
            words += map(str, values)
        elif isinstance(value, bool):
            words.append((parameter.opts if value else parameter.secondary_opts)[0])
        else:
            for one in values:
                words += [parameter.opts[0], str(one)]
    return shlex.join(words)


def check_report_options(html: Path | None, *, video: bool = False) -> None:
    """Raises an error before anything is computed if a report cannot be made."""
    from mujoco_impact.report import check_report

    if video and html is None:
        raise ConfigError("--video: no effect without --html, whose report holds it")
    check_report(html)
    if video:
        from mujoco_impact.video import check_rendering

        check_rendering("report.mp4")


@contextlib.contextmanager
def video_of(
    model: mujoco.MjSpec | mujoco.MjModel,
    panels: list[Panel],
    start: Keyframe,
    *,
    wanted: bool,
) -> Iterator[Path | None]:
    """Yields a video for a report, None if none is wanted."""
    if not wanted:
        yield None
        return
    from mujoco_impact.video import View, write_video

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "video.mp4"
        view = View(size=VIDEO_SIZE)
        yield write_video(model, panels, file, view=view, keyframe=start)


def shown_settings(settings: dict[str, Any]) -> str:
    """Returns settings as the command line takes them."""
    return ", ".join(f"{key}={value}" for key, value in settings.items()) or "defaults"
