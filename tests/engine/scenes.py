"""Scenes and readings shared by the tests of the engine."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

import cradle_models
import mujoco_impact

INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "discrete": mujoco.mjtIntegrator.mjINT_DISCRETE,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
}


@dataclass(frozen=True)
class Header:
    """The part of plugin_state that these tests read."""

    count: int
    clock: float
    active: int
    pulses: np.ndarray  # one row a slot


def header(model: mujoco.MjModel, data: mujoco.MjData) -> Header:
    start = model.plugin_stateadr[0]
    state = data.plugin_state[start : start + model.plugin_statenum[0]]
    offset, size, number = (int(n) for n in state[2:5])
    pulses = state[offset : offset + size * number].reshape(number, size)
    return Header(int(state[1]), state[5], int(state[6]), pulses.copy())


def with_integrator(xml: str, integrator: str, timestep: float) -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_string(xml)
    spec.option.integrator = INTEGRATORS[integrator]
    spec.option.timestep = timestep
    return spec


def pendulums(
    pattern: str, *, integrator: str = "Euler", timestep: float = 0.002, **options
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A row of pendulum balls at its release, owned by the plugin."""
    shape = ("release", "released", "gap", "length")
    row = {key: options.pop(key) for key in shape if key in options}
    spec = with_integrator(cradle_models.row(pattern, **row), integrator, timestep)
    model = mujoco_impact.attach(spec, **options).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return model, data


FREE_ROW = """
<mujoco>
  <option timestep="{timestep}" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>
    {balls}
  </worldbody>
</mujoco>
"""


def free_row(
    masses,
    *,
    radius: float = 0.015,
    speed: float = 0.5,
    start: float = 5e-4,
    integrator: str = "Euler",
    timestep: float = 0.002,
    **options,
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Touching free balls without gravity; the first comes in from `start` away."""
    balls = "".join(
        f'<body pos="{2 * radius * i - (start if i == 0 else 0)!r} 0 0"><freejoint/>'
        f'<geom name="ball{i}" type="sphere" size="{radius}" mass="{m}" condim="1"/>'
        "</body>"
        for i, m in enumerate(masses)
    )
    xml = FREE_ROW.format(timestep=timestep, balls=balls, integrator=integrator)
    model = mujoco_impact.attach(xml, **options).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = speed
    return model, data


def step_to_impact(
    model: mujoco.MjModel, data: mujoco.MjData, limit: int = 5000
) -> None:
    for _ in range(limit):
        mujoco.mj_step(model, data)
        if header(model, data).count:
            return
    raise AssertionError(f"no impact in {limit} steps")


def step_until_delivered(model, data, limit: int = 5000) -> None:
    step_to_impact(model, data, limit)
    for _ in range(limit):
        if not header(model, data).active:
            return
        mujoco.mj_step(model, data)
    raise AssertionError(f"a pulse is still under way after {limit} steps")
