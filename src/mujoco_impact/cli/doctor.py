"""`mujoco-impact doctor`."""

from __future__ import annotations

import dataclasses

import typer

from mujoco_impact.cli import tables
from mujoco_impact.cli.options import JsonOption
from mujoco_impact.cli.output import USER_ERROR, clean_errors, console_of, write_json
from mujoco_impact.doctor import diagnose


def doctor(json_file: JsonOption = None) -> None:
    """Check the installation and the answers of the plugin."""
    with clean_errors():
        checks = diagnose()
        healthy = all(check.passed for check in checks)
        document = {
            "healthy": healthy,
            "checks": [dataclasses.asdict(check) for check in checks],
        }
        write_json(json_file, document)
        console = console_of(json_file)
        console.print(tables.check_table(checks))
        if not healthy:
            raise typer.Exit(USER_ERROR)
        console.out("everything works")
