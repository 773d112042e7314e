"""`mujoco-impact attach`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from mujoco_impact.cli.options import (
    FrictionOption,
    GapOption,
    GeomsOption,
    IntegratorOption,
    MaterialOption,
    ModelArgument,
    ParamsOption,
    SetOption,
    SpeedOption,
    TimestepOption,
)
from mujoco_impact.cli.output import check_outputs, clean_errors, console_of
from mujoco_impact.cli.scenes import (
    assigned,
    geom_names,
    parsed_settings,
    read_scene,
)
from mujoco_impact.files import write_text
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.scene import attach as attach_scene
from mujoco_impact.specifications import compile_spec


def attach(
    model: ModelArgument,
    out: Annotated[
        Path, typer.Option("--out", "-o", help="MJCF file to write, '-' to print it.")
    ] = Path("-"),
    settings: SetOption = None,
    params: ParamsOption = None,
    friction: FrictionOption = False,
    geoms: GeomsOption = None,
    gap: GapOption = None,
    speed: SpeedOption = None,
    materials: MaterialOption = None,
    timestep: TimestepOption = None,
    integrator: IntegratorOption = None,
) -> None:
    """Write a scene as MJCF that has its impacts computed by the plugin.

    Paths of meshes in it are as in the model: put it into the same folder.
    """
    with clean_errors():
        check_outputs(out)
        options = parsed_settings(
            settings,
            params,
            friction=friction,
            geoms=geom_names(geoms),
            gap=gap,
            speed=speed,
            assign=assigned(materials),
        )
        scene = read_scene(model, timestep=timestep, integrator=integrator)
        spec = attach_scene(scene, **options)
        # MuJoCo writes what has been compiled
        compile_spec(spec)
        text = spec.to_xml()
        if str(out) == "-":
            sys.stdout.write(text)
            return
        write_text(out, text)
        (names,) = owned_geoms(spec).values()
        console = console_of(None)
        console.out(f"{out}: the impacts of {', '.join(names or ())} are ours")
