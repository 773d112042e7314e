"""Figures of the force-sensor experiment, like 5 and 6 of the paper (matplotlib)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.paper.force_sensor import Series
from mujoco_impact.paper.printed import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def waveform_figure(series: Sequence[Series]) -> Figure:
    """Returns the forces of all shots, as they are and divided by their peaks."""
    return _figure(
        series,
        curve=lambda record: (record.time, record.force),
        labels=("force [N]", "force / height"),
        spread=lambda one: one.waveform_spread,
    )


def impulse_figure(series: Sequence[Series]) -> Figure:
    """Returns the cumulated impulses, as they are and divided by the peak forces."""
    return _figure(
        series,
        curve=lambda record: record.cumulated,
        labels=("impulse [N s]", "impulse / height [s]"),
        spread=lambda one: one.impulse_spread,
    )


def write_figures(
    series: Sequence[Series], folder: str | os.PathLike[str]
) -> tuple[Path, Path]:
    """Writes both figures as PNG and returns their paths.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    paths = (
        target / "force_sensor_waveforms.png",
        target / "force_sensor_impulses.png",
    )
    figures = (waveform_figure(series), impulse_figure(series))
    for path, figure in zip(paths, figures, strict=True):
        # without the version that would change the file every time
        with replacing(path) as part:
            figure.savefig(part, dpi=110, metadata={"Software": None})
    return paths


def _figure(
    series: Sequence[Series], *, curve: Any, labels: tuple[str, str], spread: Any
) -> Figure:
    """Returns one column per rule: curves above, scaled by their height below."""
    require_matplotlib()
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    figure = Figure(figsize=(3.6 * len(series) + 0.8, 5.4), layout="constrained")
    axes = figure.subplots(2, len(series), sharex="col", squeeze=False)
    for one, (raw, scaled) in zip(series, axes.T, strict=True):
        shades = colormaps["viridis"](np.linspace(0, 0.9, len(one.records)))
        for record, shade in zip(one.records, shades, strict=True):
            time, values = _from_onset(*curve(record))
            label = f"{record.height * 1e3:.0f} mm"
            raw.plot(time, values, color=shade, linewidth=1, label=label)
            scaled.plot(time, values / record.impact.height, color=shade, linewidth=1)
        raw.set_title(one.rule, fontsize=10)
        scaled.set_title(f"largest distance {spread(one):.2g}", fontsize=9)
        scaled.set_xlabel("time from onset [ms]")
        for axis in (raw, scaled):
            axis.grid(alpha=0.25)
    axes[0, 0].set_ylabel(labels[0])
    axes[1, 0].set_ylabel(labels[1])
    lines, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(lines, names, title="let go at", loc="outside right center")
    return figure


def _from_onset(time: Array, values: Array) -> tuple[Array, Array]:
    """Returns a curve that begins with 0 at the onset, times in ms."""
    after = time > 0
    return (
        np.concatenate(([0.0], time[after] * 1e3)),
        np.concatenate(([0.0], values[after])),
    )
