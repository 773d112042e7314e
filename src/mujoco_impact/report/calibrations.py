"""Report of a calibration."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from rich.table import Table

from mujoco_impact.calibration import Calibration, Shots
from mujoco_impact.calibration.objective import Candidates, Objective
from mujoco_impact.report import figures
from mujoco_impact.report.page import Page, Section
from mujoco_impact.report.tables import of_terminal


def calibration_page(
    found: Calibration,
    shots: Shots,
    tables: Iterable[Table],
    *,
    command: str,
    facts: dict[str, str],
) -> Page:
    """Returns the page of a calibration.

    Args:
        found: What was found.
        shots: The shots that it was found from.
        tables: The tables of the terminal.
        command: The command that made the page.
        facts: What was run.
    """
    sections = [
        Section("Parameters", "".join(of_terminal(table) for table in tables)),
        Section("Measured and computed", plot=_momenta(found, shots)),
    ]
    if found.identifiability is not None:
        sections.append(Section("What the shots determine", plot=_ranges(found)))
    held = "none" if found.held_out is None else f"{found.held_out:.6f} kg m/s"
    return Page(
        title=f"Calibration with {found.shots} shots",
        command=command,
        facts={
            **facts,
            "evaluation value": f"{found.evaluation:.6f} kg m/s, "
            f"{found.evaluation / found.scale:.2%} of the momentum exchanged",
            "on shots held out": held,
            "converged": "yes" if found.converged else "no",
        },
        sections=tuple(sections),
    )


def _momenta(found: Calibration, shots: Shots) -> Any:
    """Returns the changes of momentum along the row, computed over measured."""
    measured_name, computed_name = "measured [kg m/s]", "computed [kg m/s]"
    plot = figures.new_figure(
        "Change of momentum of each ball along the row: on the line they agree",
        measured_name,
        computed_name,
        height=420,
    )
    objective = Objective(shots, w0=found.parameters.w0, kappa=found.parameters.kappa)
    computed = objective.impulses(_candidate(found))[0]
    # along the line of the first contact
    along = shots.directions[:, :1]
    measured = (objective.momentum_change * along).sum(axis=2)
    computed = (computed * along).sum(axis=2)
    ends = [float(measured.min()), float(measured.max())]
    plot.line(ends, ends, color="#adb5bd", line_dash="dashed")
    for ball in range(measured.shape[1]):
        columns = {
            measured_name: measured[:, ball].tolist(),
            computed_name: computed[:, ball].tolist(),
            "shot": list(range(1, found.shots + 1)),
        }
        colour = figures.COLOURS[ball % len(figures.COLOURS)]
        figures.add_points(plot, columns, name=f"ball {ball + 1}", colour=colour)
    return plot


def _candidate(found: Calibration) -> Candidates:
    """Returns the parameters found, as one candidate."""
    given = found.parameters
    single = (given.sh, given.sw, given.mu_s, given.mu_d)
    sh, sw, mu_s, mu_d = (np.array([float(value)]) for value in single)
    return Candidates(sh=sh, sw=sw, mu_s=mu_s, mu_d=mu_d, alpha=np.array([given.alpha]))


def _ranges(found: Calibration) -> Any:
    """Returns the intervals of what the shots determine, over their values."""
    assert found.identifiability is not None
    known = [one for one in found.identifiability.combinations if one.value]
    names = [one.name for one in known]
    plot = figures.new_figure(
        "Intervals of 95 %, over the value",
        "value / value found",
        "",
        y_range=list(reversed(names)),
        height=110 + 34 * len(names),
    )
    figures.add_ranges(
        plot,
        names,
        [one.low / one.value for one in known],
        [one.high / one.value for one in known],
        [1.0] * len(known),
        {
            "value": [f"{one.value:.5g} {one.unit}" for one in known],
            "interval": [f"{one.low:.5g} to {one.high:.5g}" for one in known],
        },
    )
    return plot
