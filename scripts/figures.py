"""Draws the pictures of the documentation into docs/images, for `scripts/figures`."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import cradle_models
import mujoco_impact
from mujoco_impact import law, reference
from mujoco_impact.paper.figures import write_figures
from mujoco_impact.paper.force_sensor import experiment

IMAGES = Path(__file__).parents[1] / "docs" / "images"
DURATION = 3.0
MOMENT = 0.56  # the last ball is at its highest [s]
LENGTH, RADIUS = 0.3, 0.015
SHADES = plt.get_cmap("viridis")(np.linspace(0, 0.9, 5))


def cradle() -> None:
    """Five balls, one lifted: MuJoCo's contacts, ours, and the Hertz reference."""
    path = cradle_models.model_path("row_5")
    motions = {}
    for title, scene in (
        ("MuJoCo's contacts", path),
        ("mujoco-impact", mujoco_impact.attach(path)),
    ):
        run = mujoco_impact.run(scene, duration=DURATION, keyframe="release")
        motions[title] = (run.time, run.qpos)
    truth = reference.pendulum_row(cradle_models.balls("AAAAA"), duration=DURATION)
    motions["reference (Hertz, resolved)"] = (run.time, truth(run.time)[0])

    figure, axes = plt.subplots(
        2, 3, figsize=(11, 5.6), height_ratios=(1.15, 1), layout="constrained"
    )
    for (title, (time, angles)), column in zip(motions.items(), axes.T, strict=True):
        draw_balls(column[0], angles[np.searchsorted(time, MOMENT)])
        column[0].set_title(title, fontweight="bold")
        for ball, shade in enumerate(SHADES):
            column[1].plot(time, np.degrees(angles[:, ball]), color=shade)
        column[1].axvline(MOMENT, color="0.6", linewidth=0.8, linestyle=":")
        column[1].set(ylim=(-34, 34), xlabel="time [s]")
        column[1].grid(alpha=0.25)
    axes[1, 0].set_ylabel("angle [deg]")
    save(figure, "cradle")


def draw_balls(axis: Axes, angles: np.ndarray) -> None:
    """Draws the row with its arms; the release of the first ball in outline."""
    for ball, angle in enumerate([*angles, -np.radians(30)]):
        pivot = 2 * RADIUS * ((ball if ball < 5 else 0) - 2)
        x, z = pivot + LENGTH * np.sin(angle), -LENGTH * np.cos(angle)
        ghost = ball == 5
        axis.plot([pivot, x], [0, z], color="0.75" if ghost else "0.35", linewidth=0.8)
        face = "none" if ghost else SHADES[ball]
        edge = "0.7" if ghost else "0.2"
        ball_shape = plt.Circle((x, z), RADIUS, facecolor=face, edgecolor=edge)
        axis.add_patch(ball_shape).set_zorder(3)
    axis.plot([-0.09, 0.09], [0, 0], color="0.2", linewidth=3)
    axis.text(0.0, 0.02, f"{MOMENT} s", ha="center", color="0.4")
    axis.set(xlim=(-0.25, 0.25), ylim=(-0.34, 0.05), aspect="equal")
    axis.axis("off")


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


def force_sensor() -> None:
    """The force-sensor experiment of the paper: waveforms and cumulated impulses."""
    for path in write_figures(experiment(), IMAGES):
        print(path)


if __name__ == "__main__":
    cradle()
    waveform()
    force_sensor()
