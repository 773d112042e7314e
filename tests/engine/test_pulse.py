"""The waveform in the engine: its impulse does not depend on the timestep."""

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, free_row, header, pendulums, step_until_delivered

MASSES = (0.115, 0.230)
SPEED = 0.5
REDUCED_MASS = 0.115 * 0.230 / (0.115 + 0.230)


def delivered_impulse(model, data) -> float:
    """Momentum of the struck ball over the incoming speed direction [N s]."""
    step_until_delivered(model, data)
    return MASSES[1] * data.qvel[6]


# MuJoCo takes over only at a depth that no pulse here reaches
WIDE = {"gap": 0.02, "depth": 0.014}


@pytest.mark.parametrize("timestep", [1e-4, 3e-4, 1e-3, 2e-3, 7e-3, 1e-2])
@pytest.mark.parametrize("width", [1e-4, 7.5e-4, 2.3e-3, 7.5e-3, 2e-2])
@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_total_impulse_is_its_closed_form(timestep, width, restitution):
    # P = (1 + e) mu u for an isolated pair, whatever the timestep and the duration; an
    # impact computed from positions and velocities leaves rounding, 1e-12
    model, data = free_row(
        MASSES,
        timestep=timestep,
        duration=width,
        restitution=restitution,
        speed=SPEED,
        **WIDE,
    )
    expected = (1 + restitution) * REDUCED_MASS * SPEED
    impulse = delivered_impulse(model, data)
    assert abs(impulse / expected - 1) < 1e-12
    pulse = header(model, data).pulses[0]
    assert pulse[4] == pytest.approx(expected, rel=1e-12)
    assert pulse[6] == width


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_every_integrator_delivers_the_same_impulse(integrator):
    model, data = free_row(
        MASSES, integrator=integrator, duration=7.5e-3, speed=SPEED, **WIDE
    )
    expected = 2 * REDUCED_MASS * SPEED
    assert abs(delivered_impulse(model, data) / expected - 1) < 1e-12


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_joint_damping_takes_nothing_from_the_impulse(integrator, duration):
    """Integrators that treat damping implicitly would eat part of a force."""
    model, data = pendulums(
        "AA", integrator=integrator, release=20.0, duration=duration, depth=0.005
    )
    model.dof_damping[:] = 0.05  # a tenth of the momentum a second
    swing = []
    for timestep in (2e-3, 2e-5):
        model.opt.timestep = timestep
        mujoco.mj_resetDataKeyframe(model, data, 0)
        while data.time < 0.5 - 1e-9:
            mujoco.mj_step(model, data)
        swing.append(data.qpos[1])
    # the swing itself differs by 6e-4 at most; without the force that makes up for the
    # damping of the position correction it lacks 1.5e-3 (hertz) and 4.4e-3
    assert swing[0] == pytest.approx(swing[1], rel=1e-3)


@pytest.mark.parametrize("timestep", [1e-4, 1e-3, 5e-3])
def test_balls_end_where_the_waveform_puts_them(timestep):
    """The position correction: the path after the pulse does not depend on h."""
    model, data = free_row(
        MASSES, timestep=timestep, duration=7.5e-3, speed=SPEED, start=7e-4, **WIDE
    )
    while data.time < 0.05 - 1e-9:
        mujoco.mj_step(model, data)
    # a symmetric pulse acts as if it came at its centre
    centre = 7e-4 / SPEED + 7.5e-3 / 2
    v = 2 * REDUCED_MASS * SPEED / MASSES[1]
    # positions of contact change by the overlap during the pulse, which turns nothing
    # here: all on a line, so the closed form holds to rounding
    assert data.qpos[7] - 0.03 == pytest.approx(v * (0.05 - centre), rel=1e-9)


def test_a_pulse_shorter_than_the_step_is_recorded_too():
    model, data = free_row(MASSES, speed=SPEED)
    step_until_delivered(model, data)
    pulse = header(model, data).pulses[0]
    assert pulse[0] == 1
    # 30 mm steel at .5 m/s: about a tenth of a millisecond, asserted by the Hertz time
    K = 4 / 3 * 2e11 / (2 * 0.91) * np.sqrt(0.0075)
    T = 2.9432751843247047 * (1.25 * REDUCED_MASS * SPEED**2 / K) ** 0.4 / SPEED
    assert pulse[6] == pytest.approx(T, rel=1e-9)
    # onset: 0.5 mm at 0.5 m/s
    assert pulse[3] == pytest.approx(5e-4 / SPEED, rel=1e-9)
