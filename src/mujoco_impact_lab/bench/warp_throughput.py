"""Throughput of cradles beside MuJoCo Warp, Warp's own contacts, and `rollout`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import cradle_models
import mujoco_impact
from mujoco_impact.extras import require
from mujoco_impact.text import markdown_table
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.machine import machine

BALLS = "AAAAA"

WORLDS = (1, 10, 100, 1_000, 10_000, 100_000)

DURATION = 1.0
"""Simulated time [s]; 500 steps, with the first impact after .3 s."""

MOST_ROLLOUTS = 1_000
"""Simulations on the processor, whose cost is in proportion."""


@dataclass(frozen=True)
class Throughput:
    """Seconds simulated in a second, by number of worlds.

    Of wall-clock time on a GPU. On Warp's CPU device, which has one thread, and for
    `rollout` of processor time, on which other load of the machine has little effect.

    Attributes:
        worlds: Number of worlds.
        ours: MuJoCo Warp with our impacts.
        warps: MuJoCo Warp with its own contacts.
        rollout: `mujoco_impact.rollout` on one thread of the processor.
        law_steps: Steps of the law of a world in that time, on the average.
        bytes_per_world: Memory of the impacts of a world [B].
    """

    worlds: int
    ours: float
    warps: float
    rollout: float
    law_steps: float
    bytes_per_world: float


def throughput(
    worlds: Sequence[int], report: Callable[[str], None]
) -> list[Throughput]:
    """Lets go the first ball of a cradle in many worlds, at as many angles.

    Args:
        worlds: Numbers of worlds to measure.
        report: Called with a line of each measurement.
    """
    spec = mujoco_impact.attach(cradle_models.row(BALLS), restitution=0.95)
    ours, plain = spec.compile(), mujoco_impact.detach(spec).compile()
    found = []
    for count in worlds:
        found.append(_measure(ours, plain, count))
        report(str(found[-1]))
    return found


def _measure(ours: mujoco.MjModel, plain: mujoco.MjModel, count: int) -> Throughput:
    """Measures one number of worlds."""
    mujoco_warp = require("mujoco_warp")
    warp = mujoco_impact.warp
    qpos: Array = np.zeros((count, len(BALLS)))
    qpos[:, 0] = -np.linspace(0.1, 0.8, count)
    impacts = warp.put_impacts(ours, nworld=count)
    m = warp.put_model(ours)
    seconds = _time(ours, qpos, lambda d: warp.step(m, d, impacts))
    impacts.check()
    other = mujoco_warp.put_model(plain)
    of_warp = _time(plain, qpos, lambda d: mujoco_warp.step(other, d))
    some = qpos[:: -(-count // MOST_ROLLOUTS)]
    steps = round(DURATION / ours.opt.timestep)
    begin = time.process_time()
    mujoco_impact.rollout(ours, duration=DURATION, qpos=some, every=steps, threads=1)
    of_rollouts = time.process_time() - begin
    return Throughput(
        worlds=count,
        ours=DURATION * count / seconds,
        warps=DURATION * count / of_warp,
        rollout=DURATION * len(some) / of_rollouts,
        # of two runs
        law_steps=float(impacts.law_step_count.mean()) / 2,
        bytes_per_world=impacts.bytes_per_world,
    )


def write_page(
    page: Path, worlds: Sequence[int], report: Callable[[str], None]
) -> None:
    """Measures and writes the page."""
    found = throughput(worlds, report)
    where = machine()
    device = _device_name()
    table = markdown_table(
        ("worlds", "ours", "Warp's own contacts", "`rollout` on one thread"),
        (
            (
                f"{one.worlds:,}",
                *(f"{n:.3g}" for n in (one.ours, one.warps, one.rollout)),
            )
            for one in found
        ),
    )
    text = f"""# Impacts on MuJoCo Warp: throughput

Written by `python -m mujoco_impact_lab warp`, on {device}; `rollout` on
one thread of {where["processor"]}. MuJoCo {mujoco.mj_versionString()}.

Five balls, e = .95, of which the first is let go at angles from .1 to .8 rad: seconds
simulated in one second, all worlds together, at a timestep of 2 ms.

{table}
A world takes {found[-1].law_steps:.0f} steps of the law in that second, on the average.
Its impacts have {found[-1].bytes_per_world:.0f} B on the device.
{_NO_GPU if device.startswith("Warp's CPU device") else ""}"""
    page.write_text(text.rstrip() + "\n", encoding="utf-8")


_NO_GPU = """
No GPU was at hand for these numbers. Warp's CPU device runs one world after another on
one thread, so they tell what a world costs there, and nothing about a GPU.
"""


def _time(model: mujoco.MjModel, qpos: Array, step: Callable[[Any], None]) -> float:
    """Returns how long all steps take [s], the second time: the first compiles."""
    mujoco_warp, wp = require("mujoco_warp"), require("warp")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    d = mujoco_warp.put_data(model, data, nworld=len(qpos), nconmax=16, njmax=16)
    steps = round(DURATION / model.opt.timestep)
    on_gpu = wp.get_device().is_cuda
    clock = time.perf_counter if on_gpu else time.process_time
    graph = None
    taken = 0.0
    for timed in (False, True):
        for array in (d.qvel, d.time, d.qacc_warmstart):
            array.zero_()
        d.qpos.assign(qpos.astype(np.float32))
        if timed and on_gpu:
            with wp.ScopedCapture() as capture:
                step(d)
            graph = capture.graph
        wp.synchronize()
        begin = clock()
        for _ in range(steps):
            if graph is None:
                step(d)
            else:
                wp.capture_launch(graph)
        wp.synchronize()
        taken = clock() - begin
    return taken


def _device_name() -> str:
    """Returns the name of the card, or what runs instead."""
    device = require("warp").get_device()
    if device.is_cuda:
        return str(device.name)
    return f"Warp's CPU device, {machine()['processor']}"
