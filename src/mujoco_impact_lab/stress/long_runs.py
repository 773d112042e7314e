"""Long runs: an elastic cradle for an hour, a dissipative one until and after rest."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import mujoco
import numpy as np

import cradle_models
from mujoco_impact.baselines import baselines
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.scene import attach
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.stress.methods import OURS

HOUR = 3600.0
"""Simulated time of the elastic run [s]."""

SWING = 300.0
"""Simulated time in which a dissipative cradle comes to rest together [s]."""

REST = 600.0
"""Simulated time of rest after that [s]."""

CHUNK = 1000
"""Steps between two samples."""

RESTITUTION = 0.9
"""Of the dissipative cradle."""

DAMPING = 1e-3
"""Of its joints [N m s/rad]: a swing dies out in ten seconds. Without it a cradle whose
balls swing together never stops."""


@dataclasses.dataclass(frozen=True, eq=False)
class LongRun:
    """One long run of one method.

    Attributes:
        run: "elastic" or "dissipative".
        method: Its name.
        duration: Simulated time reached [s].
        steps: Steps taken.
        finite: Whether every sample is finite and MuJoCo warned of nothing.
        note: The first warning, "" if none.
        energy: Energy over that at the start, in each sample, shape (n,).
        order: Largest amount by which neighbours swapped places [m]; 0 if never.
        drift: Mean of the angles in the last tenth of the run [rad].
        speed: Largest speed of a ball in the last tenth [m/s].
    """

    run: str
    method: str
    duration: float
    steps: int
    finite: bool
    note: str
    energy: Array
    order: float
    drift: float
    speed: float


def long_runs(
    *,
    hour: float = HOUR,
    swing: float = SWING,
    rest: float = REST,
    progress: Callable[[str], None] | None = None,
) -> list[LongRun]:
    """Runs both cradles, under our impacts and under MuJoCo's tuned contacts."""
    report = progress or (lambda _: None)
    path = cradle_models.model_path("row_5")
    runs = []
    for name, restitution, duration in (
        ("elastic", 1.0, hour),
        ("dissipative", RESTITUTION, swing + rest),
    ):
        plain = mujoco.MjSpec.from_file(str(path))
        if name == "dissipative":
            for joint in plain.joints:
                joint.damping[0] = DAMPING
        # the damper needs no impact speed
        tuned = baselines(plain, impact_speed=1.0, restitution=restitution)[1]
        for method, spec in (
            (OURS, attach(plain, restitution=restitution)),
            (tuned.name, tuned.spec),
        ):
            report(f"{name}: {method}")
            runs.append(_run(name, method, spec.compile(), duration))
    return runs


def _run(name: str, method: str, model: mujoco.MjModel, duration: float) -> LongRun:
    """Runs one cradle in chunks."""
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    bottom = _potential_at_rest(model)
    start = float(data.energy.sum()) - bottom
    spacing = np.diff(model.body_pos[1:, 0])
    energy, angles, speeds = [1.0], [data.qpos.copy()], [0.0]
    order, steps = 0.0, 0
    with collected_warnings() as messages:
        while steps * model.opt.timestep < duration and not messages:
            mujoco.mj_step(model, data, nstep=CHUNK)
            steps += CHUNK
            mujoco.mj_forward(model, data)
            energy.append((float(data.energy.sum()) - bottom) / start)
            angles.append(data.qpos.copy())
            speeds.append(_fastest(model, data))
            between = np.diff(data.xipos[1:, 0])
            order = max(order, float(-np.min(between) if len(spacing) else 0.0))
    last = max(1, len(angles) // 10)
    return LongRun(
        run=name,
        method=method,
        duration=steps * float(model.opt.timestep),
        steps=steps,
        finite=not messages and bool(np.isfinite(energy).all()),
        note=messages[0].strip() if messages else "",
        energy=np.array(energy),
        order=order,
        drift=float(np.mean(angles[-last:])),
        speed=max(speeds[-last:]),
    )


def _potential_at_rest(model: mujoco.MjModel) -> float:
    """Returns the potential energy with all balls hanging down [J]."""
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_forward(model, data)
    return float(data.energy[0])


def _fastest(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Returns the largest speed of a ball [m/s]."""
    velocity = np.zeros(6)
    fastest = 0.0
    for body in range(1, model.nbody):
        mujoco.mj_objectVelocity(
            model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0
        )
        fastest = max(fastest, float(np.linalg.norm(velocity[3:])))
    return fastest
