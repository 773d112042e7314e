"""The stress report as markdown: docs/stress.md."""

from __future__ import annotations

import platform
from collections.abc import Sequence

import mujoco

from mujoco_impact.text import markdown_table
from mujoco_impact_lab.stress.family import Family
from mujoco_impact_lab.stress.long_runs import DAMPING, RESTITUTION, LongRun
from mujoco_impact_lab.stress.methods import OURS
from mujoco_impact_lab.stress.summary import Summary, Tally

HEAD = """\
# Stress report

Written by `scripts/stress`; do not edit. Random scenes, long runs, and what of the
promises held. A scene is reproduced by its family and its seed:

    python -m mujoco_impact_lab stress --family balls --seed N
"""


def update(report: str, family: Family, section: str) -> str:
    """Returns a report with the section of a family in it, new or replaced.

    Args:
        report: The report so far, "" for a new one.
        family: Of the section.
        section: Its text.
    """
    marks = f"<!-- {family.name} -->\n", f"<!-- end of {family.name} -->\n"
    block = marks[0] + section + marks[1]
    before, found, rest = (report or HEAD).partition(marks[0])
    if not found:
        return before + "\n" + block
    _, _, after = rest.partition(marks[1])
    return before + block + after


def section(
    family: Family, summary: Summary, runs: Sequence[LongRun], elapsed: float
) -> str:
    """Returns the section of a family.

    Args:
        family: The kind of the scenes.
        summary: The sweep.
        runs: The long runs, if there are any.
        elapsed: Wall time of the sweep [s].
    """
    parts = [
        f"## Random {family.name}\n\n{family.about}",
        _machine(summary, elapsed),
        _promises(family),
        *(_method(summary, method) for method in summary.methods),
        _comparison(family, summary) if len(family.methods) > 1 else "",
        _limits(family, summary),
        _long_runs(runs) if runs else "",
    ]
    return "\n".join(part for part in parts if part)


def _machine(summary: Summary, elapsed: float) -> str:
    """Tells what was run on what."""
    failed = len(summary.failures)
    slowest = ""
    if summary.slowdown is not None:
        ratio, seed = summary.slowdown
        slowest = (
            f"Our slowest step took {ratio:.0f} times the processor time of MuJoCo's "
            f"usual one in the same scene (seed {seed}). "
        )
    return (
        f"{summary.cases} scenes, {summary.struck} with an impact, "
        f"{summary.impacts} impacts; {failed} could not be run; "
        f"{elapsed / 60:.0f} min. {slowest}MuJoCo {mujoco.mj_versionString()}, "
        f"Python {platform.python_version()}, {platform.machine()}.\n"
    )


def _promises(family: Family) -> str:
    """Lists the invariants with their bounds and reasons."""
    rows = [
        (invariant.name, invariant.promise, f"{invariant.bound:g}", invariant.reason)
        for invariant in family.invariants
    ]
    return "### The promises\n\n" + markdown_table(
        ("name", "promise", "bound", "why that bound"), rows
    )


def _method(summary: Summary, method: str) -> str:
    """Returns the table of one method."""
    rows = [_row(tally) for tally in summary.tallies if tally.method == method]
    text = (
        f"### {method}: {summary.violations(method)} violations\n\n"
        + markdown_table(
            (
                "promise",
                "scenes judged",
                "violations",
                "outside of the limits",
                "worst within",
                "worst outside",
                "seeds of the worst",
            ),
            rows,
        )
    )
    if summary.failures and method == OURS:
        text += "\nCould not be run:\n\n"
        for seed, why in summary.failures.items():
            text += f"* seed {seed}: {why}\n"
    return text


def _row(tally: Tally) -> tuple[str, ...]:
    """Returns one line of a method's table."""
    beyond = ", ".join(f"{count} {name}" for name, count in tally.beyond.items())
    return (
        tally.invariant,
        str(tally.judged),
        str(tally.violations),
        beyond or "0",
        f"{tally.worst:.2g}",
        f"{tally.worst_beyond:.2g}" if tally.beyond else "-",
        " ".join(map(str, tally.seeds)) or "-",
    )


def _comparison(family: Family, summary: Summary) -> str:
    """Returns violations per promise, method beside method, without any limits."""
    rows = []
    for invariant in family.invariants:
        cells = [invariant.name]
        for method in family.methods:
            tally = summary.tally(method, invariant.name)
            if tally is None:
                cells.append("-")
                continue
            broken = tally.violations + sum(tally.beyond.values())
            cells.append(f"{broken} of {tally.judged}")
        rows.append(cells)
    return (
        "### Side by side\n\nScenes in which a promise is broken, those outside of "
        "our documented limits included: the same scenes for every method.\n\n"
        + markdown_table(("promise", *family.methods), rows)
    )


def _limits(family: Family, summary: Summary) -> str:
    """Explains the limits and counts what is outside of them."""
    rows = []
    for limit in family.limits:
        count = sum(
            tally.beyond.get(limit.name, 0)
            for tally in summary.tallies
            if tally.method == OURS
        )
        touched = ", ".join(
            i.name for i in family.invariants if i.name in limit.invariants
        )
        rows.append((limit.name, limit.meaning, touched, str(count)))
    return (
        "### Outside of the limits\n\nWhat a scene does outside of the documented "
        "limits is counted apart, not hidden.\n\n"
        + markdown_table(
            ("limit", "a scene is outside if", "touches", "broken promises"), rows
        )
    )


def _long_runs(runs: Sequence[LongRun]) -> str:
    """Returns the table of the long runs."""
    rows = [
        (
            run.run,
            run.method,
            f"{run.duration:.0f} s, {run.steps} steps",
            "yes" if run.finite else f"no: {run.note}",
            f"{run.energy[-1]:.4g}",
            f"{run.energy.min():.4g} to {run.energy.max():.4g}",
            f"{run.order:.2g}",
            f"{run.drift:+.2g}",
            f"{run.speed:.2g}",
        )
        for run in runs
    ]
    return (
        "### Long runs\n\nThe shipped cradle of five balls (`row_5`) at 2 ms, Euler: "
        "elastic for an hour, and with "
        f"e = {RESTITUTION} and {DAMPING:g} N m s/rad in the joints until it hangs "
        "still and ten minutes longer. Energies are over that at the release; "
        "the drift is the mean angle of the last tenth, the speed the largest "
        "in it.\n\n"
        + markdown_table(
            (
                "run",
                "method",
                "reached",
                "finite",
                "energy at the end",
                "energy between",
                "places swapped by [m]",
                "drift [rad]",
                "speed at the end [m/s]",
            ),
            rows,
        )
    )
