"""`run`: states, energies, impacts and what can go wrong."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mujoco_impact import attach, run
from mujoco_impact.errors import SceneError, SimulationError
from mujoco_impact.mujoco_warnings import collected_warnings

PENDULUM = """
<mujoco>
  <option timestep="0.001" integrator="{integrator}"/>
  <worldbody>
    <body name="bob"><joint name="hinge" axis="0 1 0"/>
      <geom size=".02" mass=".3" pos="0 0 -.4"/></body>
  </worldbody>
  <keyframe><key name="up" qpos="1"/><key qpos="2"/></keyframe>
</mujoco>
"""

# the positions are exact to rounding, the impulse to the tolerances of the law
VELOCITY_TOLERANCE = 1e-5


def stepped(model: mujoco.MjModel, keyframe: int, steps: int) -> np.ndarray:
    """Returns positions and velocities by plain mj_step, shape (steps + 1, nq + nv)."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, keyframe)
    rows = [np.concatenate([data.qpos, data.qvel])]
    for _ in range(steps):
        mujoco.mj_step(model, data)
        rows.append(np.concatenate([data.qpos, data.qvel]))
    return np.array(rows)


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
def test_records_the_motion_of_mj_step(integrator: str) -> None:
    """Recording changes nothing: bit for bit the states of plain stepping."""
    xml = PENDULUM.format(integrator=integrator)
    model = mujoco.MjModel.from_xml_string(xml)
    trajectory = run(xml, duration=0.05, keyframe="up")
    expected = stepped(model, 0, 50)
    np.testing.assert_array_equal(trajectory.qpos, expected[:, :1])
    np.testing.assert_array_equal(trajectory.qvel, expected[:, 1:])
    np.testing.assert_allclose(trajectory.time, np.arange(51) * 1e-3, atol=1e-15)
    assert trajectory.integrator == integrator
    assert trajectory.timestep == 1e-3
    assert trajectory.mujoco_version == mujoco.mj_versionString()


def test_every_takes_each_nth_state() -> None:
    """The samples are those of the finer record."""
    xml = PENDULUM.format(integrator="Euler")
    fine = run(xml, duration=0.05, keyframe=1)
    coarse = run(xml, duration=0.05, keyframe=1, every=7)
    for name in ("time", "qpos", "qvel", "energy"):
        np.testing.assert_array_equal(getattr(coarse, name), getattr(fine, name)[::7])


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "discrete", "RK4"])
def test_energies_are_those_of_the_sampled_states(integrator: str) -> None:
    """Potential m g z and kinetic I w^2 / 2 of a pendulum, in closed form."""
    xml = PENDULUM.format(integrator=integrator)
    trajectory = run(xml, duration=0.05, keyframe="up")
    angle, rate = trajectory.qpos[:, 0], trajectory.qvel[:, 0]
    inertia = 0.3 * (0.4**2 + 0.4 * 0.02**2)
    potential = -0.3 * 9.81 * 0.4 * np.cos(angle)
    # rounding of sums of a few terms
    np.testing.assert_allclose(trajectory.energy[:, 0], potential, rtol=1e-13)
    np.testing.assert_allclose(
        trajectory.energy[:, 1], inertia * rate**2 / 2, rtol=1e-12, atol=1e-18
    )


def test_the_model_given_is_not_changed() -> None:
    """Energies are switched on in a copy."""
    model = mujoco.MjModel.from_xml_string(PENDULUM.format(integrator="Euler"))
    run(model, duration=0.01)
    assert model.opt.enableflags == 0


def test_initial_state_can_be_given() -> None:
    """On top of a keyframe."""
    xml = PENDULUM.format(integrator="Euler")
    trajectory = run(xml, duration=0.01, keyframe="up", qvel=[3.0])
    assert trajectory.qpos[0, 0] == 1.0
    assert trajectory.qvel[0, 0] == 3.0
    assert run(xml, duration=0.01, qpos=[0.5]).qpos[0, 0] == 0.5


def test_controller_acts_before_each_step() -> None:
    """A constant torque without gravity gives its integral."""
    xml = PENDULUM.format(integrator="Euler").replace(
        "<option ", '<option gravity="0 0 0" '
    )
    times: list[float] = []

    def push(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        times.append(data.time)
        data.qfrc_applied[0] = 0.1

    trajectory = run(xml, duration=0.02, controller=push)
    np.testing.assert_allclose(times, trajectory.time[:-1])
    inertia = 0.3 * (0.4**2 + 0.4 * 0.02**2)
    assert trajectory.qvel[-1, 0] == pytest.approx(0.1 * 0.02 / inertia, rel=1e-9)


def test_progress_reaches_the_end() -> None:
    """Fractions rise from 0 to 1."""
    seen: list[float] = []
    run(PENDULUM.format(integrator="Euler"), duration=0.5, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[0] == 0.0
    assert seen[-1] == 1.0


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast"])
@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_impact_of_two_balls_is_recorded(
    two_balls: str, integrator: str, restitution: float
) -> None:
    """One impact, at the time of touching, with the impulse mu (1 + e) v."""
    xml = two_balls.replace("<option ", f'<option integrator="{integrator}" ')
    trajectory = run(
        attach(xml, restitution=restitution), duration=0.02, keyframe="shot"
    )
    (impact,) = trajectory.impacts
    assert set(impact.geoms) == {"left", "right"}
    # 5.1 mm at 1 m/s, known within the compression of a Hertz contact, micrometres
    assert impact.time == pytest.approx(5.1e-3, abs=2e-5)
    impulse = 0.05 * (1 + restitution)
    assert impact.impulse == pytest.approx(impulse, rel=VELOCITY_TOLERANCE)
    assert impact.alpha == pytest.approx(1.0, rel=VELOCITY_TOLERANCE)
    assert impact.restitution == pytest.approx(restitution)
    assert impact.height == pytest.approx(
        math.pi * impact.impulse / (2 * impact.duration)
    )
    expected = [(1 - restitution) / 2, (1 + restitution) / 2]
    np.testing.assert_allclose(trajectory.qvel[-1], expected, atol=VELOCITY_TOLERANCE)
    assert trajectory.missed_impacts == 0


def test_mujocos_own_contacts_have_no_impacts(two_balls: str) -> None:
    """The scene without the plugin: the record is ours only."""
    trajectory = run(two_balls, duration=0.02, keyframe="shot")
    assert trajectory.impacts == ()
    assert abs(trajectory.qvel[-1, 1] - 1.0) > 0.1


def test_impacts_of_two_instances_are_merged_in_order_of_time() -> None:
    """Each instance keeps its own slots."""
    xml = """<mujoco><option gravity="0 0 0"/>
      <default><joint type="slide" axis="1 0 0"/><geom size=".01" mass=".1"/></default>
      <worldbody>
        <body pos="-.03 0 0"><joint/><geom name="a"/></body>
        <body pos="0 0 0"><joint/><geom name="b"/></body>
        <body pos="-.025 1 0"><joint/><geom name="c"/></body>
        <body pos="0 1 0"><joint/><geom name="d"/></body>
      </worldbody></mujoco>"""
    spec = attach(attach(xml, geoms=["a", "b"]), geoms=["c", "d"], name="second")
    trajectory = run(spec, duration=0.03, qvel=[1.0, 0.0, 1.0, 0.0])
    assert [set(impact.geoms) for impact in trajectory.impacts] == [
        {"c", "d"},
        {"a", "b"},
    ]


def test_divergence_is_an_error_with_its_time() -> None:
    """MuJoCo itself would reset the state and go on; no log file is left."""
    stiff = """<mujoco><option timestep=".01" gravity="0 0 0"/>
      <worldbody><body><joint name="x" type="slide" stiffness="1e9"/>
      <geom size=".1"/></body></worldbody></mujoco>"""
    before = sorted(Path.cwd().iterdir())
    with pytest.raises(SimulationError, match=r"step at 0\..*unstable") as caught:
        run(stiff, duration=1.0, qpos=[0.1])
    assert 0.0 < caught.value.time < 1.0
    assert sorted(Path.cwd().iterdir()) == before


def test_warning_handler_is_given_back() -> None:
    """Also after an error."""
    before = mujoco.get_mju_user_warning()
    with pytest.raises(KeyError), collected_warnings():
        raise KeyError
    assert mujoco.get_mju_user_warning() is before


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"keyframe": "down"}, r"no keyframe 'down' \(available: up, 1\)"),
        ({"keyframe": 2}, "no keyframe 2"),
        ({"qpos": [1.0, 2.0]}, r"qpos has shape \(2,\), the model needs \(1,\)"),
    ],
)
def test_wrong_initial_states_are_refused(
    arguments: dict[str, object], reason: str
) -> None:
    """With what is available."""
    with pytest.raises(SceneError, match=reason):
        run(PENDULUM.format(integrator="Euler"), duration=0.1, **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"duration": 0.0}, r"duration = 0.0: must be a time > 0 \[s\]"),
        ({"duration": math.inf}, "duration = inf"),
        ({"duration": 1.0, "every": 0}, "every = 0"),
    ],
)
def test_wrong_lengths_are_refused(arguments: dict[str, object], reason: str) -> None:
    """With the value and what is allowed."""
    with pytest.raises(ValueError, match=reason):
        run(PENDULUM.format(integrator="Euler"), **arguments)  # type: ignore[arg-type]
