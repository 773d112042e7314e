"""`mujoco-impact paper` and `mujoco-impact force-sensor`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.table import Table

from mujoco_impact.cli.options import JsonOption
from mujoco_impact.cli.output import (
    check_outputs,
    clean_errors,
    console_of,
    progress,
    write_json,
)
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import write_text

if TYPE_CHECKING:
    from mujoco_impact.paper.force_sensor import Series


def paper(
    out: Annotated[
        Path | None, typer.Option(help="Markdown file to write as well.")
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Run the eight patterns of the paper beside what it prints."""
    from mujoco_impact.paper import results, sheets

    with clean_errors():
        check_outputs(out, json_file)
        with progress(json_file) as report:
            found = results.paper_results(report)
        write_json(json_file, found.to_dict())
        if out is not None:
            write_text(out, sheets.markdown(found))
        console = console_of(json_file)
        for sheet in sheets.sheets(found):
            table = Table(title=sheet.title, box=None)
            for number, heading in enumerate(sheet.headings):
                side: Literal["left", "right"] = "right" if number else "left"
                table.add_column(heading, justify=side, no_wrap=True)
            for row in sheet.rows:
                table.add_row(*(cell.replace("**", "") for cell in row))
            console.print(table)
            console.print(sheet.note, style="dim")
            console.print()
        if out is not None:
            console.out(f"written: {out}")


def force_sensor(
    out: Annotated[Path, typer.Option(help="Folder for the two figures.")] = Path(),
    json_file: JsonOption = None,
) -> None:
    """Swing a ball against a force sensor from ten heights; draw figures 5 and 6."""
    from mujoco_impact.paper import figures
    from mujoco_impact.paper.force_sensor import experiment

    with clean_errors():
        check_outputs(json_file)
        require_matplotlib()
        with progress(json_file) as report:
            series = experiment(report)
        pictures = figures.write_figures(series, out)
        write_json(
            json_file,
            {
                "series": [one.to_dict() for one in series],
                "pictures": [str(picture) for picture in pictures],
            },
        )
        console = console_of(json_file)
        console.print(_spread_table(series))
        console.out(f"pictures: {', '.join(map(str, pictures))}")


def _spread_table(series: Sequence[Series]) -> Table:
    """Returns how far shots are from one another under each rule for the duration."""
    table = Table(
        title="largest distance between two shots, scaled by height", box=None
    )
    table.add_column("duration")
    for heading in ("W [ms]", "waveforms", "impulses", "waveforms, time / W"):
        table.add_column(heading, justify="right")
    for one in series:
        widths = [record.impact.duration * 1e3 for record in one.records]
        table.add_row(
            one.rule,
            f"{min(widths):.3g} to {max(widths):.3g}",
            f"{one.waveform_spread:.2g}",
            f"{one.impulse_spread:.2g}",
            f"{one.shape_spread:.2g}",
        )
    return table
