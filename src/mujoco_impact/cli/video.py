"""`mujoco-impact video`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

import typer

from mujoco_impact.cli.options import (
    STANDARD_INPUT,
    DurationOption,
    FrictionOption,
    GeomsOption,
    KeyframeOption,
    ModelArgument,
    ParamsOption,
    SetOption,
)
from mujoco_impact.cli.output import check_outputs, clean_errors, console_of, progress
from mujoco_impact.cli.scenes import (
    geom_names,
    parsed_settings,
    scene_of,
    start_keyframe,
)
from mujoco_impact.errors import ConfigError
from mujoco_impact.runner import run
from mujoco_impact.starts import Keyframe

CameraOption = Annotated[
    str | None,
    typer.Option(
        help="Camera of the model, name or number [default: its first one that stands "
        "still, else one that sees all that moves]."
    ),
]
SizeOption = Annotated[
    str, typer.Option(metavar="WxH", help="Width and height of each panel [pixels].")
]


def video(
    model: ModelArgument,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Video to write: .mp4, .gif or .webp; .png is one picture "
            "[default: MODEL.mp4]."
        ),
    ] = None,
    compare: Annotated[
        bool,
        typer.Option(
            "--compare",
            help="MuJoCo's own contacts beside ours, and the reference if there is "
            "one.",
        ),
    ] = False,
    duration: DurationOption = 3.0,
    speed: Annotated[
        float,
        typer.Option(help="Simulated seconds in a second of video; 0.1: slowed down."),
    ] = 1.0,
    camera: CameraOption = None,
    size: SizeOption = "480x360",
    fps: Annotated[int, typer.Option(help="Pictures per second of video.")] = 25,
    arrows: Annotated[
        bool, typer.Option("--arrows/--no-arrows", help="Arrows of the impulses.")
    ] = True,
    at: Annotated[
        float | None,
        typer.Option(help="Time of a .png [s] [default: that of the first impact]."),
    ] = None,
    keyframe: KeyframeOption = None,
    geoms: GeomsOption = None,
    settings: SetOption = None,
    params: ParamsOption = None,
    friction: FrictionOption = False,
    closing_speed: Annotated[
        float | None,
        typer.Option(
            help="Closing speed of the fastest impact expected [m/s], the --speed of "
            "`run`."
        ),
    ] = None,
) -> None:
    """Make a video of a scene with our impacts, with MuJoCo's beside them if asked."""
    with clean_errors():
        from mujoco_impact import video as videos

        name = "scene" if model == STANDARD_INPUT else Path(model).stem
        target = out or Path(f"{name}.mp4")
        view = videos.View(
            speed=speed, camera=camera, size=_size(size), fps=fps, arrows=arrows
        )
        view.times(duration)
        # told before anything is computed
        check_outputs(target)
        videos.check_rendering(target, at)
        law = parsed_settings(settings, params, friction=friction)
        attaching = parsed_settings(None, geoms=geom_names(geoms), speed=closing_speed)
        spec = scene_of(
            model, attaching | law, native=False, speed_option="--closing-speed"
        )
        start = start_keyframe(spec, keyframe)
        with progress(None) as report:
            report("simulating")
            panels = _panels(spec, duration, start, law, compare=compare)
            written = videos.write_video(
                spec,
                panels,
                target,
                view=view,
                keyframe=start,
                at=at,
                progress=lambda fraction: report(f"drawing {fraction:4.0%}"),
            )
        console = console_of(None)
        for panel in panels:
            drawn = f" (impacts drawn: {len(panel.impacts)})" if panel.impacts else ""
            console.out(f"{panel.caption}{drawn}")
        kind = "picture" if written.suffix.lower() == ".png" else "video"
        console.out(f"{kind}: {written}")


def _panels(
    spec: Any,
    duration: float,
    start: Keyframe,
    law: dict[str, Any],
    *,
    compare: bool,
) -> list[Any]:
    """Returns the motions to show; MuJoCo's comes first, as in the pictures."""
    from mujoco_impact.comparison import OURS
    from mujoco_impact.video.motion import Panel
    from mujoco_impact.video.scenes import native_panel, reference_panel

    motion = run(spec, duration=duration, keyframe=start)
    ours = Panel.of(motion, OURS)
    if not compare:
        return [ours]
    reference = reference_panel(spec, motion, law)
    native = native_panel(spec, duration, {"keyframe": start})
    return [native, ours] if reference is None else [native, ours, reference]


def _size(text: str) -> tuple[int, int]:
    """Returns width and height of a text such as "640x480"."""
    match = re.fullmatch(r"(\d{1,5})[xX](\d{1,5})", text)
    if match is None:
        raise ConfigError(f"--size {text!r}: must be WxH in pixels, such as 640x480")
    return int(match[1]), int(match[2])
