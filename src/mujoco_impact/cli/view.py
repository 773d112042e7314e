"""`mujoco-impact view`."""

from __future__ import annotations

from typing import Annotated

import typer

from mujoco_impact.cli.options import (
    FrictionOption,
    GeomsOption,
    KeyframeOption,
    ModelArgument,
    ParamsOption,
    SetOption,
)
from mujoco_impact.cli.output import clean_errors, console_of
from mujoco_impact.cli.scenes import (
    geom_names,
    parsed_settings,
    scene_of,
    start_keyframe,
)


def view(
    model: ModelArgument,
    keyframe: KeyframeOption = None,
    geoms: GeomsOption = None,
    settings: SetOption = None,
    params: ParamsOption = None,
    friction: FrictionOption = False,
    seconds: Annotated[
        float | None,
        typer.Option(min=0, help="Close the window after this time by the clock [s]."),
    ] = None,
) -> None:
    """Watch a scene live in MuJoCo's viewer; the window tells its keys."""
    with clean_errors():
        from mujoco_impact.video import dressed
        from mujoco_impact.viewer.session import Session
        from mujoco_impact.viewer.window import check_display, show

        check_display()
        law = parsed_settings(
            settings, params, friction=friction, geoms=geom_names(geoms)
        )
        spec = scene_of(model, law, native=False)
        session = Session(dressed(spec), keyframe=start_keyframe(spec, keyframe))
        show(session, seconds=seconds)
        for name, value in session.lines():
            console_of(None).out(f"{name}: {value}" if name else value)
