"""What the trainings came to: a file, a table and a picture."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np

from mujoco_impact.extras import require_matplotlib
from mujoco_impact.text import markdown_table
from mujoco_impact_lab.training.comparison import (
    EPISODE,
    Comparison,
    Score,
    Training,
)

COLORS = ("tab:blue", "tab:red", "tab:orange")
"""Of the learning curves."""


def write(found: Comparison, folder: Path) -> tuple[Path, Path]:
    """Writes training.json and training.png; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    data, picture = folder / "training.json", folder / "training.png"
    text = json.dumps(dataclasses.asdict(found), indent=1)
    data.write_text(text + "\n", encoding="utf-8")
    draw(found, picture)
    return data, picture


def read(file: Path) -> Comparison:
    """Returns what `write` wrote to a file."""
    found = json.loads(file.read_text(encoding="utf-8"))
    return Comparison(
        trainings={
            name: Training(**{**one, "scores": [Score(**s) for s in one["scores"]]})
            for name, one in found["trainings"].items()
        },
        scores={
            player: {name: Score(**one) for name, one in row.items()}
            for player, row in found["scores"].items()
        },
    )


def table(found: Comparison) -> str:
    """Returns the scores of all players under all contacts, as Markdown.

    The last line tells how many balls the scripted player sends out at once.
    """
    contacts = list(found.trainings)
    lines = {player: _shown(row, contacts) for player, row in found.scores.items()}
    out = [f"{found.scores['scripted'][name].balls:.1f}" for name in contacts]
    lines["balls that go out, scripted"] = out
    heading = ("played under", *contacts)
    return markdown_table(heading, [[name, *line] for name, line in lines.items()])


def _shown(row: dict[str, Score], contacts: list[str]) -> list[str]:
    """Returns mean and standard deviation under each kind of contacts."""
    scores = [row[name] for name in contacts]
    return [f"{one.mean:.0f} ± {one.deviation:.0f}" for one in scores]


def draw(found: Comparison, file: Path) -> None:
    """Draws the learning curves, and random and scripted players beside them."""
    require_matplotlib()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.subplots()
    for (name, training), color in zip(found.trainings.items(), COLORS, strict=True):
        mean = np.array([one.mean for one in training.scores])
        spread = np.array([one.deviation for one in training.scores])
        axes.plot(training.generations, mean, color=color, label=name)
        axes.fill_between(
            training.generations, mean - spread, mean + spread,
            color=color, alpha=0.1, linewidth=0,
        )  # fmt: skip
    (own,) = list(found.trainings)[:1]
    for player in ("scripted", "random"):
        height = found.scores[player][own].mean
        axes.axhline(height, color="0.4", linewidth=1, linestyle="--")
        axes.annotate(
            f"{player}, under {own}", (1.0, height), xycoords=("axes fraction", "data"),
            xytext=(-4, 3), textcoords="offset points", ha="right", color="0.4",
        )  # fmt: skip
    axes.set(xlabel="generation", ylabel="score (sum of rewards)", ylim=(0, EPISODE))
    axes.set_xlim(0, max(training.generations))
    axes.legend(
        title="trained and played under",
        loc="upper left",
        bbox_to_anchor=(0.0, 0.94),
        frameon=False,
    )
    axes.grid(alpha=0.25)
    figure.savefig(file, dpi=120, metadata={"Software": None})
