"""The command `stress`: random scenes, or one of them by its seed."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Set as AbstractSet
from pathlib import Path
from typing import Annotated

import typer

from mujoco_impact.cli.options import JsonOption
from mujoco_impact.cli.output import (
    check_outputs,
    clean_errors,
    console_of,
    progress,
    write_json,
)
from mujoco_impact.errors import ConfigError
from mujoco_impact.files import write_text
from mujoco_impact_lab import stress as stressing
from mujoco_impact_lab.stress import FAMILIES, OURS, Family, markdown
from mujoco_impact_lab.stress.long_runs import long_runs

VIOLATION = 1
"""Exit code when a promise is broken within the documented limits."""

_CASE = frozenset({"seed", "family", "shrink", "ours_only", "json_file"})
_SWEEP = frozenset(
    {"family", "cases", "first", "processes", "ours_only", "long", "out", "json_file"}
)


def stress(
    context: typer.Context,
    family: Annotated[
        str, typer.Option(help="Kind of random scenes: balls, shapes or materials.")
    ] = "balls",
    cases: Annotated[int, typer.Option(min=1, help="Random scenes to judge.")] = 100,
    first: Annotated[
        int, typer.Option(min=0, help="Seed of the first random scene.")
    ] = 0,
    seed: Annotated[
        int | None,
        typer.Option(
            min=0, help="Only the random scene of this seed, and what broke in it."
        ),
    ] = None,
    shrink: Annotated[
        bool,
        typer.Option("--shrink", help="With --seed: also the simplest that breaks."),
    ] = False,
    processes: Annotated[int, typer.Option(min=1, help="Scenes to run at a time.")] = 1,
    ours_only: Annotated[
        bool, typer.Option("--ours-only", help="Leave MuJoCo's own contacts out.")
    ] = False,
    long: Annotated[
        bool, typer.Option("--long", help="Also run cradles for an hour of motion.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Report to write (markdown).")
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Look for where impacts break in random scenes."""
    with clean_errors():
        check_outputs(out, json_file)
        if seed is not None:
            _refuse_other_options(context, _CASE, "--seed")
            _show_case(seed, _family(family), shrink, ours_only, json_file)
        else:
            _refuse_other_options(context, _SWEEP, "random scenes without --seed")
            seeds = range(first, first + cases)
            _sweep(_family(family), seeds, processes, ours_only, long, out, json_file)


def _refuse_other_options(
    context: typer.Context, used: AbstractSet[str], mode: str
) -> None:
    """Refuses options of the command line that would have no effect."""
    for option in context.command.params:
        name = option.name or ""
        source = context.get_parameter_source(name)
        given = source is not None and source.name == "COMMANDLINE"
        if given and name not in used:
            msg = f"{option.opts[0]}: no effect on {mode}: leave it out"
            raise ConfigError(msg)


def _family(name: str) -> Family:
    """Returns a family of random scenes by its name."""
    if name not in FAMILIES:
        msg = f"family = {name!r}: must be one of {', '.join(FAMILIES)}"
        raise ConfigError(msg)
    return FAMILIES[name]


def _sweep(
    family: Family,
    seeds: range,
    processes: int,
    ours_only: bool,
    long: bool,
    out: Path | None,
    json_file: str | None,
) -> None:
    """Judges random scenes and reports."""
    console = console_of(json_file)
    methods = (OURS,) if ours_only else family.methods
    begin = time.perf_counter()
    judged: list[stressing.Outcome] = []
    stopped = False
    with progress(json_file) as tell:

        def one_more(outcome: stressing.Outcome) -> None:
            judged.append(outcome)
            tell(f"scene {len(judged)} of {len(seeds)}")
            for verdict in outcome.verdicts:
                if verdict.is_violation and verdict.method == OURS:
                    console.out(f"{verdict.invariant}: {verdict.value:.3g} in")
                    console.out(f"  {outcome.case.describe()}")

        try:
            outcomes = stressing.sweep(
                seeds,
                family=family,
                methods=methods,
                processes=processes,
                progress=one_more,
            )
        except KeyboardInterrupt:
            if not judged:
                raise
            outcomes, stopped = judged, True
        elapsed = time.perf_counter() - begin
        runs = long_runs(progress=tell) if long and not stopped else []
    summary = stressing.summarise(outcomes, family)
    text = markdown.section(family, summary, runs, elapsed)
    if out is not None:
        # the other families keep what they have in the report
        before = out.read_text(encoding="utf-8") if out.exists() else ""
        write_text(out, markdown.update(before, family, text))
        console.out(f"report: {out}")
    else:
        console.out(text)
    write_json(json_file, dataclasses.asdict(summary))
    broken = summary.violations(OURS)
    console.out(
        f"{summary.cases} scenes, {summary.impacts} impacts, {broken} violations"
    )
    if stopped:
        raise KeyboardInterrupt(f"interrupted after {len(judged)} scenes")
    if broken:
        raise typer.Exit(VIOLATION)


def _show_case(
    seed: int, family: Family, shrink: bool, ours_only: bool, json_file: str | None
) -> None:
    """Shows one random scene and its verdicts."""
    case = family.case_of(seed)
    methods = (OURS,) if ours_only else None
    outcome = stressing.judge(case, methods, family=family)
    console = console_of(json_file)
    console.out(case.describe())
    if outcome.failure:
        console.out(f"could not be run: {outcome.failure}")
    for verdict in outcome.verdicts:
        word = "holds" if verdict.holds else verdict.limit or "VIOLATED"
        console.out(
            f"{verdict.method:16} {verdict.invariant:16} {verdict.value:10.3g}  {word}"
        )
    broken = [
        verdict.invariant
        for verdict in outcome.verdicts
        if verdict.is_violation and verdict.method == OURS
    ]
    if broken:
        for line in family.story(family.evidence_of(case, OURS)):
            console.out(line)
    for invariant in broken if shrink else ():
        simplest = stressing.shrunk(case, invariant, family)
        console.out(f"the simplest found that breaks {invariant}: {simplest!r}")
        for line in family.story(family.evidence_of(simplest, OURS)):
            console.out(line)
    write_json(json_file, dataclasses.asdict(outcome))
