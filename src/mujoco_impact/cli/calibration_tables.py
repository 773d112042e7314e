"""Tables of a calibration for the terminal."""

from __future__ import annotations

from rich.table import Table

from mujoco_impact.calibration import Calibration, Identifiability


def parameter_table(found: Calibration) -> Table:
    """Returns the parameters, with the values that would fit as well."""
    table = Table(title="parameters", box=None)
    table.add_column("name")
    table.add_column("value", justify="right")
    if found.identifiability is None:
        for name, value in found.settings.items():
            table.add_row(name, str(value))
        return table
    table.add_column("as good", justify="right")
    table.add_column("")
    for one in found.identifiability.ranges:
        table.add_row(
            one.name, f"{one.value:.6g}", f"{one.low:.4g} to {one.high:.4g}", one.note
        )
    return table


def combination_table(found: Identifiability) -> Table:
    """Returns what the shots determine, with its intervals."""
    table = Table(title="what the shots determine", box=None)
    table.add_column("combination")
    for heading in ("value", "interval of 95 %", "unit"):
        table.add_column(heading, justify="right" if heading != "unit" else "left")
    for one in found.combinations:
        table.add_row(
            one.name, f"{one.value:.5g}", f"{one.low:.5g} to {one.high:.5g}", one.unit
        )
    return table
