"""The results as tables of text, for the terminal and for docs/paper_results.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_impact.paper.patterns import RESTITUTION
from mujoco_impact.paper.readings import (
    KAPPAS,
    best_kappa,
    first_contact,
    second_contact,
)
from mujoco_impact.paper.results import CONSERVED, LAWS, PaperResults, PatternResult
from mujoco_impact.text import markdown_table

NOTHING = "-"


@dataclass(frozen=True)
class Sheet:
    """A table of text.

    Attributes:
        title: What it shows.
        note: How to read it, a sentence or more.
        headings: One per column.
        rows: Cells, one row per line.
    """

    title: str
    note: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def sheets(results: PaperResults) -> tuple[Sheet, ...]:
    """Returns all tables."""
    return (
        _impulses(results),
        _residuals(results),
        _print(results),
        _energies(results),
        _ratios(results),
        _heights(results),
        _first_contact(),
        _second_contact(),
    )


def markdown(results: PaperResults) -> str:
    """Returns docs/paper_results.md."""
    lines = [
        "# The eight patterns of the paper",
        "",
        "Written by `mujoco-impact paper --out docs/paper_results.md`; what it means",
        "is told in [paper.md](paper.md).",
    ]
    for sheet in sheets(results):
        lines += ["", f"## {sheet.title}", "", sheet.note, ""]
        lines += markdown_table(sheet.headings, sheet.rows).splitlines()
    return "\n".join(lines) + "\n"


def _impulses(results: PaperResults) -> Sheet:
    """Returns m dv and P of every ball, printed and by the laws."""
    rows = []
    for pattern, one in results.patterns.items():
        columns = [one.printed.change[:, 2], _printed_impulse(one)]
        columns += [outcome.impulse for outcome in one.outcomes.values()]
        for ball in range(3):
            cells = [_milli(column[ball]) for column in columns]
            if not one.conserved:
                cells[0] += " !"
            rows.append((pattern, str(ball + 1), *cells))
    return Sheet(
        "Momentum and impulse along the row",
        "z components in 1e-3 kg m/s. m dv and P as printed, means of ten shots (!: "
        "these m dv do not conserve momentum). Then P of the models at the impact "
        f"speed of table 4, {results.speed:.4f} m/s: by equation (6) with the "
        "parameters of table 3 and no passivity guard, in SI and with kappa = 0.083, "
        "and by the law "
        f"`hertz` at e = {RESTITUTION}.",
        ("pattern", "ball", "m dv", "P", *LAWS),
        tuple(rows),
    )


def _residuals(results: PaperResults) -> Sheet:
    """Returns |m dv - P| of every ball, printed and by the laws."""
    rows = []
    for pattern, one in results.patterns.items():
        columns: list[Any] = [
            [np.nan] * 3 if values is None else values
            for values in one.residuals().values()
        ]
        for ball in range(3):
            cells = [_milli(column[ball]) for column in columns]
            rows.append(
                (pattern + ("" if one.conserved else " !"), str(ball + 1), *cells)
            )
    return Sheet(
        "Residuals",
        "|m dv - P| along the row in 1e-3 kg m/s, with the m dv that are printed (!: "
        "these do not conserve momentum, so no P can meet them).",
        ("pattern", "ball", "P", *LAWS),
        tuple(rows),
    )


def _print(results: PaperResults) -> Sheet:
    """Returns what is wrong with the printed tables."""
    rows = []
    for pattern, one in results.patterns.items():
        given = one.printed
        copied = [str(ball) for ball, copy in enumerate(given.copied, start=1) if copy]
        values = given.evaluations()
        again = [NOTHING] * 3
        if values is not None:
            again = [f"{value:.4f}" for value in values]
            again.append(f"{values[0] / given.evaluation:.0f}")
        rows.append(
            (
                pattern,
                str(given.table),
                f"{given.imbalance:+.1%}",
                "yes" if one.conserved else "**no**",
                ", ".join(copied) or "none",
                f"{given.evaluation:.4f}",
                *again,
            )
        )
    return Sheet(
        "What is printed",
        "Sum of m dv_z over that of ball 1, and whether momentum is conserved (within "
        f"{CONSERVED:.0%}). Balls whose m dv is the velocity change of table 4 times "
        "the mass, to the last digit. The evaluation value of table 3; that of the "
        "printed means, as the sum of lengths and as the sum of components: a lower "
        "bound, since the mean of lengths is not less than the length of a mean; and "
        "the ratio of the two. "
        "The P of AAB stands in a table without a caption.",
        ("pattern", "table", "sum", "conserved", "copied", "printed",
         "lengths", "parts", "ratio"),
        tuple(rows),
    )  # fmt: skip


def _energies(results: PaperResults) -> Sheet:
    """Returns the kinetic energy after the impact over that before."""
    rows = []
    for pattern, one in results.patterns.items():
        P = _printed_impulse(one)
        before = 0.5 * one.printed.masses[0] * results.speed**2
        velocity = np.array([results.speed, 0, 0]) + P / one.printed.masses
        after = 0.5 * (one.printed.masses * velocity**2).sum()
        cells = [_number(after / before)]
        for name, outcome in one.outcomes.items():
            cells.append(f"{outcome.energy:.3f}")
            if name in one.guarded:
                cells.append(f"{one.guarded[name]:.3f}")
        rows.append((pattern, *cells))
    headings = [
        heading
        for name, law in LAWS.items()
        for heading in ([name] if law["law"] == "hertz" else [name, "guarded"])
    ]
    return Sheet(
        "Kinetic energy after the impact over that before",
        "Above 1: the law adds energy. `guarded`: with the passivity guard, which "
        "every scene has unless `passive` is false.",
        ("pattern", "P as printed", *headings),
        tuple(rows),
    )


def _ratios(results: PaperResults) -> Sheet:
    """Returns alpha_2/alpha_1, printed, computed and calibrated."""
    rows = []
    for pattern, one in results.patterns.items():
        found = one.interval("alpha_2/alpha_1")
        numbers = (one.printed_ratio, *one.ratio, found.value)
        cells = [f"{number:.3f}" for number in numbers]
        rows.append((pattern, *cells, f"{found.low:.3f} to {found.high:.3f}"))
    miss = [
        np.log(one.printed_ratio / one.ratio[1]) for one in results.patterns.values()
    ]
    return Sheet(
        "alpha_2/alpha_1",
        "Of table 3; P_23/P_12 of the Hertz impact with e = 1 and with "
        f"e = {RESTITUTION}; and what the calibration finds on ten synthetic shots "
        f"(Hertz, e = {RESTITUTION}, two 500 Hz cameras), with its interval of 95 %. "
        "The printed ratios are off the Hertz impact by "
        f"{np.sqrt(np.mean(np.square(miss))):.1%} (RMS of the logarithm).",
        ("pattern", "printed", "e = 1", f"e = {RESTITUTION}", "calibrated", "interval"),
        tuple(rows),
    )


def _heights(results: PaperResults) -> Sheet:
    """Returns alpha_1 S_h, printed, computed and calibrated."""
    rows = []
    for pattern, one in results.patterns.items():
        found, given = one.interval("alpha_1 S_h"), one.printed.parameters
        # P_12 = (2/π) α_1 S_h W_0 p
        hertz = one.share * np.pi / 2 / given.w0
        numbers = (given.alpha[0] * given.sh, hertz, found.value)
        cells = [f"{number:.1f}" for number in numbers]
        rows.append((pattern, *cells, f"{found.low:.1f} to {found.high:.1f}"))
    return Sheet(
        "alpha_1 S_h",
        "N s/(kg m). Of table 3, where S_w adds to it; what gives the P_12 of the "
        f"Hertz impact with e = {RESTITUTION} and S_w = 0; and what the calibration "
        "finds.",
        ("pattern", "printed", f"e = {RESTITUTION}", "calibrated", "interval"),
        tuple(rows),
    )


def _first_contact() -> Sheet:
    """Returns how well units of S_w explain the first contact."""
    best = best_kappa()
    readings = [first_contact(kappa) for kappa in KAPPAS]
    rows = [
        (f"{one.kappa:g}", f"{one.area:.3f}", f"{one.miss:.1%}") for one in readings
    ]
    rows.append((f"{best.kappa:.3f} (best)", f"{best.area:.3f}", f"{best.miss:.1%}"))
    return Sheet(
        "Unit of S_w, and area of the waveform",
        "How far the P_12 of equation (6) with table 3 is from that of the Hertz "
        f"impact (e = {RESTITUTION}), RMS of the logarithm over the eight patterns, "
        "with the one area of the waveform of unit height and duration that fits best: "
        "half sine 0.637, parabola 0.667, triangle 0.5, rectangle 1.",
        ("kappa", "area", "off by"),
        tuple(rows),
    )


def _second_contact() -> Sheet:
    """Returns how well momenta explain the second contact."""
    return Sheet(
        "What feeds the second contact",
        "How far P_23/P_12 by equation (6) with table 3 is from the five printed P "
        "tables, RMS of the logarithm, for several momenta in the waveform of contact "
        "2.",
        ("momentum", "off by"),
        tuple((one.feed, f"{one.miss:.0%}") for one in second_contact()),
    )


def _printed_impulse(one: PatternResult) -> np.ndarray:
    """Returns the printed P_z, NaN where there is none."""
    P = one.printed.impulse
    return np.full(3, np.nan) if P is None else P[:, 2]


def _milli(value: float) -> str:
    """Returns an impulse in 1e-3 kg m/s, or a dash."""
    return _number(value * 1e3)


def _number(value: float) -> str:
    """Returns a number with two decimals, or a dash."""
    return NOTHING if np.isnan(value) else f"{value:.2f}"
