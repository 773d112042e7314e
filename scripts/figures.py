"""Draws the pictures of the documentation into docs/images, for `scripts/figures`."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from mujoco_impact import law, sweep
from mujoco_impact.cli import app
from mujoco_impact.paper.figures import write_figures
from mujoco_impact.paper.force_sensor import experiment

IMAGES = Path(__file__).parents[1] / "docs" / "images"


def cradle() -> None:
    """Five balls, one lifted, two periods: MuJoCo's contacts, ours, the reference."""
    command = ["video", "row_5", "--compare", "--duration", "2.22", "--speed", "0.5"]
    command += ["--size", "320x280", "--out", str(IMAGES / "cradle.webp")]
    app(command, standalone_mode=False)


def waveform() -> None:
    """The artificial impulse waveform, and what a step of the simulation gets of it."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3), layout="constrained")
    time = np.linspace(0, 1, 400)
    for e in (1.0, 0.7, 0.4):
        delivered = [law.waveform_cumulative(t, e) for t in time]
        axes[0].plot(time, np.gradient(delivered, time), label=f"E = {e}")
    axes[0].set(
        xlabel="time / W", ylabel="force W / P", title="Waveform: same P, H and W"
    )
    axes[0].legend()
    steps = np.arange(-0.1, 1.3, 0.22)
    edges = [law.waveform_cumulative(float(t), 0.7) for t in steps]
    axes[1].plot(
        time, np.gradient([law.waveform_cumulative(t, 0.7) for t in time], time)
    )
    axes[1].stairs(np.diff(edges) / np.diff(steps), steps, color="crimson")
    axes[1].set(xlabel="time / W", title="What the steps deliver: their exact averages")
    for axis in axes:
        axis.grid(alpha=0.25)
    save(figure, "waveform")


def save(figure: plt.Figure, name: str) -> None:
    """Writes a picture without the date and version that would change every time."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    figure.savefig(IMAGES / f"{name}.png", dpi=110, metadata={"Software": None})
    plt.close(figure)
    print(IMAGES / f"{name}.png")


def impact_speed() -> None:
    """The example of sweeps: MuJoCo's best settings over impact speed, beside ours."""
    example = IMAGES.parent / "examples" / "impact_speed.toml"
    print(sweep(example).plot(IMAGES / "impact_speed.png"))


def force_sensor() -> None:
    """The force-sensor experiment of the paper: waveforms and cumulated impulses."""
    for path in write_figures(experiment(), IMAGES):
        print(path)


if __name__ == "__main__":
    cradle()
    waveform()
    force_sensor()
    impact_speed()
