"""What a run says about itself: too fast, through each other, energy from nowhere."""

from __future__ import annotations

import warnings

import mujoco
import numpy as np
import pytest

import cradle_models
from mujoco_impact import Trajectory, attach, run
from mujoco_impact.errors import ConfigError, ImpactWarning, SimulationError
from mujoco_impact.remarks import ENERGY, FAST, NO_IMPACT, PASSING
from mujoco_impact.verdict.free_flight import FreeRotation

SHOT = """
<mujoco>
  <option timestep="0.002" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>
    <geom name="wall" type="box" size=".005 1 1" pos="1 0 0"/>
    <body><freejoint/><geom name="ball" size=".02" mass=".1"/></body>
  </worldbody>
</mujoco>
"""

BOX = """
<mujoco>
  <option timestep="0.002" integrator="{integrator}"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="die" pos="0 0 .3" euler="20 30 0"><freejoint/>
      <geom name="die" type="box" size=".05 .03 .02" density="1000"/></body>
  </worldbody>
  <default><geom condim="1"/></default>
</mujoco>
"""


def kinds(trajectory: Trajectory) -> list[str]:
    """Returns the kinds of the remarks."""
    return [remark.kind for remark in trajectory.remarks]


def shot(*, integrator: str = "Euler", expected: float | None = None) -> Trajectory:
    """Returns the flight of a ball at 60 m/s towards a thin wall 1 m away."""
    scene = attach(SHOT.format(integrator=integrator), speed=expected)
    return run(scene, duration=0.02, qvel=[60, 0, 0, 0, 0, 0])


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
def test_a_ball_faster_than_its_gap_is_warned_of_once(integrator: str) -> None:
    """With its name, what it misses, its speed, and the gap to set."""
    with pytest.warns(ImpactWarning) as caught:
        trajectory = shot(integrator=integrator)
    (warning,) = caught
    for word in ("'ball'", "'wall'", "60 m/s", "0.01 m", "0.002 s", "gap=0.15"):
        assert word in str(warning.message)
    assert kinds(trajectory) == [FAST]
    assert trajectory.qvel[-1, 0] == pytest.approx(60.0)


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_the_speed_expected_sets_a_gap_that_sees_the_impact(integrator: str) -> None:
    """What the warning says to do is enough."""
    trajectory = shot(integrator=integrator, expected=60.0)
    assert kinds(trajectory) == []
    assert len(trajectory.impacts) == 1
    # the impulse is the tolerance of the law
    assert trajectory.qvel[-1, 0] == pytest.approx(-60.0, rel=1e-5)


def test_the_speed_makes_no_gap_smaller_than_the_default() -> None:
    """A slow impact is no reason to see less."""
    plain = attach(SHOT.format(integrator="Euler")).compile()
    slow = attach(SHOT.format(integrator="Euler"), speed=1e-3).compile()
    np.testing.assert_array_equal(slow.geom_gap, plain.geom_gap)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"speed": 0.0}, r"speed = 0.0: must be a speed > 0 \[m/s\]"),
        ({"speed": 1.0, "gap": 0.1}, "give one of them"),
    ],
)
def test_a_wrong_speed_is_refused(options: dict[str, float], reason: str) -> None:
    """With its value and what is allowed."""
    with pytest.raises(ConfigError, match=reason):
        attach(SHOT.format(integrator="Euler"), **options)  # type: ignore[arg-type]


def test_a_fast_ball_that_meets_nothing_is_not_warned_of() -> None:
    """Past the wall, along it, and away from it."""
    scene = attach(SHOT.format(integrator="Euler"))
    for qpos, qvel in (
        ([0, 0, 0, 1, 0, 0, 0], [0, 60, 0, 0, 0, 0]),
        ([1.05, 0, 0, 1, 0, 0, 0], [60, 0, 0, 0, 0, 0]),
        ([0.974, 0, 0, 1, 0, 0, 0], [0, 60, 0, 0, 0, 0]),
    ):
        trajectory = run(scene, duration=0.05, qpos=qpos, qvel=qvel)
        assert FAST not in kinds(trajectory)


def test_what_cannot_collide_is_not_warned_of() -> None:
    """A wall of another contact type, and one that is excluded."""
    other = SHOT.format(integrator="Euler").replace(
        'name="wall"', 'name="wall" contype="2" conaffinity="2"'
    )
    target = (
        '<body pos=".5 0 0"><freejoint/><geom name="b" size=".02" mass="1"/></body>'
    )
    excluded = other.replace("<body>", '<body name="a">').replace(
        "</worldbody>",
        target.replace("<body ", '<body name="b" ')
        + '</worldbody><contact><exclude body1="a" body2="b"/></contact>',
    )
    for xml, count in ((other, 1), (excluded, 2)):
        qvel = np.zeros(6 * count)
        qvel[0] = 60.0
        assert kinds(run(attach(xml), duration=0.02, qvel=qvel)) == [NO_IMPACT]


def test_a_fast_body_that_is_not_owned_is_seen_by_what_is() -> None:
    """The owned ball rests, the other one comes."""
    xml = SHOT.format(integrator="Euler").replace(
        "</worldbody>",
        '<body pos="-.5 0 0"><freejoint/><geom name="bullet" size=".005" mass=".01"/>'
        "</body></worldbody>",
    )
    qvel = np.zeros(12)
    qvel[6] = 200.0
    with pytest.warns(ImpactWarning, match=r"'ball'.*'bullet' at 200 m/s"):
        run(attach(xml, geoms=["ball"]), duration=0.005, qvel=qvel)


def test_the_tip_of_a_fast_rod_is_seen() -> None:
    """A hinge turns at 100 rad/s: its tip does 50 m/s, its middle half of it."""
    xml = """<mujoco><option gravity="0 0 0"/><worldbody>
      <geom name="post" size=".01" pos="0 .49 0"/>
      <body><joint axis="0 0 1"/><geom name="rod" type="capsule" size=".005"
        fromto="0 0 0 .5 0 0" mass="1"/></body></worldbody></mujoco>"""
    with pytest.warns(ImpactWarning, match=r"'rod' closes in on 'post' at 4\d"):
        run(attach(xml), duration=0.03, qvel=[100.0])


SHAPES = {
    "capsule": 'type="capsule" size=".02 .03"',
    "ellipsoid": 'type="ellipsoid" size=".02 .03 .04"',
    "cylinder": 'type="cylinder" size=".02 .03"',
    "box": 'type="box" size=".02 .03 .04"',
    "mesh": 'type="mesh" mesh="wedge"',
}
HEIGHTS = " ".join(["0"] * 100)


@pytest.mark.parametrize("floor", ["plane", "hfield", *SHAPES])
@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_is_seen(shape: str, floor: str) -> None:
    """MuJoCo measures the distance of all pairs."""
    grounds = {
        "plane": 'type="plane" size="1 1 1"',
        "hfield": 'type="hfield" hfield="h"',
        **SHAPES,
    }
    xml = f"""<mujoco><option gravity="0 0 0" integrator="RK4"/><asset>
      <hfield name="h" nrow="10" ncol="10" size="1 1 .1 .1" elevation="{HEIGHTS}"/>
      <mesh name="wedge" vertex="0 0 0 .05 0 0 0 .05 0 0 0 .05"/></asset><worldbody>
      <geom name="floor" {grounds[floor]}/><body pos="0 0 .5"><freejoint/>
      <geom name="it" {SHAPES[shape]}/></body></worldbody></mujoco>"""
    with pytest.warns(ImpactWarning, match="'it' closes in on 'floor'"):
        run(attach(xml), duration=0.02, qvel=[0, 0, -60, 3, 2, 1])


def test_coarse_samples_miss_no_fast_body() -> None:
    """Steps are looked at, not samples."""
    scene = attach(SHOT.format(integrator="Euler"))
    with pytest.warns(ImpactWarning, match="60 m/s"):
        run(scene, duration=0.02, qvel=[60, 0, 0, 0, 0, 0], every=10)


def test_bodies_that_go_through_each_other_are_told() -> None:
    """A ball that is pressed through MuJoCo's contact, which carries it at rest."""
    weak = SHOT.format(integrator="Euler").replace(
        "<worldbody>",
        '<default><geom solref="1" solimp="1e-3 1e-3 1"/></default><worldbody>',
    )

    def press(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.qfrc_applied[0] = 10.0

    qpos = [0.975, 0, 0, 1, 0, 0, 0]
    scene = attach(weak, restitution=0.0)
    with pytest.warns(ImpactWarning, match="pass through each other"):
        trajectory = run(scene, duration=0.4, qpos=qpos, controller=press)
    assert kinds(trajectory) == [PASSING]


def test_a_run_in_which_nothing_touches_says_so_without_a_warning() -> None:
    """That is no fault."""
    trajectory = run(attach(SHOT.format(integrator="Euler")), duration=0.02)
    assert kinds(trajectory) == [NO_IMPACT]
    assert "run longer" in trajectory.remarks[0].text


def test_a_body_at_rest_on_another_has_touched_it() -> None:
    """A run without impacts is not always a run without contacts."""
    xml = BOX.format(integrator="Euler").replace('.3" euler="20 30 0"', '.0199"')
    slow = attach(xml, restitution=0.0)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*have no record")
        assert kinds(run(slow, duration=0.1)) == []
    path = cradle_models.model_path("row_3")
    assert kinds(run(attach(path), duration=0.1)) == []


def test_energy_of_a_tumbling_body_is_blamed_on_euler() -> None:
    """And not on the impacts; the cure helps."""
    with pytest.warns(ImpactWarning) as caught:
        trajectory = run(attach(BOX.format(integrator="Euler")), duration=1.0)
    (warning,) = caught
    for words in ("energy grew", "Euler integrator", "'die'", "implicitfast", "RK4"):
        assert words in str(warning.message)
    assert kinds(trajectory) == [ENERGY]
    assert kinds(run(attach(BOX.format(integrator="RK4")), duration=1.0)) == []


@pytest.mark.parametrize("joint", ["<freejoint/>", '<joint type="ball"/>'])
def test_the_gain_of_free_rotation_is_the_one_blamed(joint: str) -> None:
    """In closed form, h^2/2 t . I^-1 t in each step: all that the energy grows by."""
    xml = f"""<mujoco><option gravity="0 0 0" timestep=".002"/><worldbody>
      <body euler="10 20 30">{joint}<geom type="box" size=".05 .03 .02" euler="5 5 5"/>
      </body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    qvel = np.zeros(model.nv)
    qvel[-3:] = (10.0, 15.0, 5.0)
    with pytest.warns(ImpactWarning, match="free rotation of 'body 1'"):
        trajectory = run(model, duration=1.0, qvel=qvel)
    grown = trajectory.energy[-1, 1] - trajectory.energy[0, 1]
    gain = FreeRotation(model).gain(trajectory.qvel[:-1]).sum()
    # a step that turns the axes by h w changes it by h^2 w^2
    assert grown == pytest.approx(gain, rel=1e-3)


def test_a_spring_that_its_timestep_blows_up_is_not_blamed_on_rotation() -> None:
    """Although there is a body that could tumble."""
    xml = BOX.format(integrator="Euler").replace(
        "</worldbody>",
        '<body pos="3 0 1"><joint type="slide" stiffness="4.05e6" pos="0 0 0"/>'
        '<geom size=".1" mass="4"/></body></worldbody>',
    )
    qvel = np.zeros(7)
    qvel[-1] = 1e-3
    with (
        pytest.warns(ImpactWarning, match="the integrator at a timestep of 0.002"),
        pytest.raises(SimulationError),
    ):
        run(attach(xml), duration=1.0, qvel=qvel)


def test_a_run_that_diverges_still_says_why() -> None:
    """Before the error."""
    scene = attach(BOX.format(integrator="Euler").replace("0.002", "0.005"))
    with pytest.warns(ImpactWarning) as caught, pytest.raises(SimulationError):
        run(scene, duration=6.0)
    assert any("free rotation of 'die'" in str(one.message) for one in caught)


def test_a_run_that_breaks_off_is_judged_by_what_it_has() -> None:
    """A pendulum of negative energy, and a force beyond all bounds: no false alarm."""

    def push(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.qfrc_applied[0] = 1e30 if data.time > 0.1 else 0.0

    with pytest.raises(SimulationError):
        run(
            attach(cradle_models.model_path("row_3")),
            duration=0.5,
            keyframe="release",
            controller=push,
        )


def test_impacts_that_add_energy_are_blamed_themselves() -> None:
    """The paper's equations as printed, without the guard of passivity."""
    scene = attach(
        cradle_models.model_path("row_3"),
        law="calibrated",
        sh=900.0,
        alpha=[1.0, 1.0],
        passive=False,
    )
    with pytest.warns(ImpactWarning, match=r"the impacts added it.*passive"):
        trajectory = run(scene, duration=0.5, keyframe="release")
    assert ENERGY in kinds(trajectory)


def test_remarks_survive_a_file(tmp_path) -> None:
    """With kind and text."""
    with pytest.warns(ImpactWarning):
        trajectory = shot()
    again = Trajectory.load(trajectory.save(tmp_path / "shot"))
    assert again.remarks == trajectory.remarks


SANE = {
    "bouncing ball, coarse steps": (
        '<option timestep=".01"/>',
        '<body pos="0 0 .3"><freejoint/><geom size=".05"/></body>',
        "",
    ),
    "motor": (
        "",
        '<body pos="0 0 .1"><joint name="x" type="slide" axis="1 0 0"/>'
        '<geom size=".05"/></body>',
        '<actuator><motor joint="x" ctrlrange="-9 9"/></actuator>',
    ),
    "velocity servo": (
        '<option integrator="implicitfast"/>',
        '<body pos="0 0 .1"><joint name="x" type="slide" axis="1 0 0"/>'
        '<geom size=".05"/></body>',
        '<actuator><velocity joint="x" kv="1000"/></actuator>',
    ),
    "position servo": (
        "",
        '<body pos="0 0 .3"><joint name="x" axis="0 1 0"/>'
        '<geom type="capsule" size=".02" fromto="0 0 0 .2 0 0"/></body>',
        '<actuator><position joint="x" kp="20" dampratio="1"/></actuator>',
    ),
    "stiff spring": (
        "",
        '<body pos="0 0 .3"><joint type="slide" stiffness="4000" springref=".1"/>'
        '<geom size=".05"/></body>',
        "",
    ),
    "damped": (
        "",
        '<body pos="0 0 .3"><joint type="slide" damping="40"/>'
        '<geom size=".05"/></body>',
        "",
    ),
    "weld that starts torn": (
        "",
        '<body name="a" pos="0 0 .3"><freejoint/><geom size=".05"/></body>'
        '<body name="b" pos=".3 0 .3"><freejoint/><geom size=".05"/></body>',
        '<equality><weld body1="a" body2="b" relpose=".2 0 0 1 0 0 0"/></equality>',
    ),
    "gravity compensated": (
        "",
        '<body pos="0 0 .3" gravcomp="1.5"><freejoint/><geom size=".05"/></body>',
        "",
    ),
    "wind": (
        '<option wind="5 0 0" density="1.2" viscosity="1e-5"/>',
        '<body pos="0 0 .3"><freejoint/><geom size=".05" density="5"/></body>',
        "",
    ),
    "asleep": (
        '<option><flag sleep="enable"/></option>',
        '<body pos="0 0 .049"><freejoint/><geom size=".05"/></body>'
        '<body pos="0 0 .4"><freejoint/><geom size=".05"/></body>',
        "",
    ),
    "conveyor": (
        "",
        '<body pos="0 0 .14"><freejoint/><geom type="box" size=".1 .1 .04"/></body>'
        '<geom type="box" size="1 1 .05" pos="0 0 .05" surfacevel="3 0 0 0 0 0"/>',
        "",
    ),
    "limits": (
        "",
        '<body pos="0 0 .5"><joint axis="0 1 0" range="-30 30"/>'
        '<geom type="capsule" size=".02" fromto="0 0 0 .2 0 0"/></body>',
        "",
    ),
    "overlap at the start": (
        "",
        '<body pos="0 0 .03"><freejoint/><geom size=".05"/></body>',
        "",
    ),
}


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
@pytest.mark.parametrize("case", SANE)
def test_a_sane_scene_says_nothing(case: str, integrator: str) -> None:
    """No false alarm: forces account for what energy there is."""
    head, bodies, tail = SANE[case]
    xml = (
        f"<mujoco>{head}<worldbody>"
        f'<geom name="floor" type="plane" size="9 9 1"/>{bodies}</worldbody>{tail}'
        "</mujoco>"
    )
    spec = mujoco.MjSpec.from_string(xml)
    if "integrator" not in head:
        name = f"mjINT_{integrator.upper()}"
        spec.option.integrator = getattr(mujoco.mjtIntegrator, name)

    def drive(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.ctrl[:] = 2.0 if data.time < 0.3 else -1.0

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # of boxes that come to rest; the motion is computed
        warnings.filterwarnings("ignore", message=".*have no record")
        trajectory = run(
            attach(spec, restitution=0.9),
            duration=1.0,
            controller=drive if "actuator" in tail else None,
        )
    assert set(kinds(trajectory)) <= {NO_IMPACT}


def test_forces_from_outside_account_for_their_work() -> None:
    """Kicks of one step by forces on bodies and on joints."""

    def kick(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.xfrc_applied[1, 0] = 30.0 if 0.1 < data.time < 0.103 else 0.0
        data.qfrc_applied[1] = 30.0 if 0.2 < data.time < 0.203 else 0.0

    scene = attach(SHOT.format(integrator="Euler"))
    trajectory = run(scene, duration=0.4, controller=kick)
    assert np.linalg.norm(trajectory.qvel[-1]) > 0.5
    assert ENERGY not in kinds(trajectory)


def test_a_state_that_is_set_from_outside_has_no_balance() -> None:
    """A controller that throws the ball gives it energy."""

    def throw(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.qvel[0] = 5.0

    scene = attach(SHOT.format(integrator="Euler"))
    assert ENERGY not in kinds(run(scene, duration=0.1, controller=throw))


def test_a_mocap_body_may_give_energy() -> None:
    """It pulls the ball by a weld."""
    xml = (
        SHOT.format(integrator="Euler")
        .replace("<body>", '<body name="hand" mocap="true"/><body name="ball">')
        .replace(
            "</worldbody>",
            '</worldbody><equality><weld body1="hand" body2="ball"/></equality>',
        )
    )

    def pull(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.mocap_pos[0, 0] = data.time

    trajectory = run(attach(xml), duration=0.5, controller=pull)
    assert trajectory.energy[-1, 1] > 0.01
    assert ENERGY not in kinds(trajectory)


PADDLE = """
<mujoco>
  <option gravity="0 0 {gravity}" integrator="{integrator}"/>
  <worldbody>
    <body name="paddle" mocap="true"><geom name="paddle" type="box" size=".1 .1 .01"/>
    </body>
    <body name="ball" pos="0 0 .1"><freejoint/><geom name="ball" size=".02"/></body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
@pytest.mark.parametrize("gravity", [0.0, -9.81])
def test_a_mocap_paddle_gives_energy_and_has_none(
    gravity: float, integrator: str
) -> None:
    """It lifts its own weight, and strikes the ball: all that is the user's work."""

    def lift(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.mocap_pos[0, 2] += 0.5 * model.opt.timestep

    scene = attach(PADDLE.format(gravity=gravity, integrator=integrator))
    trajectory = run(scene, duration=0.5, controller=lift)
    assert trajectory.impacts
    assert ENERGY not in kinds(trajectory)
    mass = scene.compile().body("ball").mass[0]
    height = trajectory.qpos[:, 2]
    # of the ball alone, to rounding
    np.testing.assert_allclose(
        trajectory.energy[:, 0], -gravity * mass * height, atol=1e-12
    )


@pytest.mark.parametrize(
    ("lift", "turn", "x", "z", "told"),
    [
        (30.0, 0.0, 0.0, 0.1, "'ball' closes in on 'paddle' at 30 m/s"),
        (0.0, 150.0, 0.08, 0.075, "'ball' closes in on 'paddle' at 14"),
    ],
)
def test_a_mocap_body_faster_than_its_gap_is_warned_of(
    lift: float, turn: float, x: float, z: float, told: str
) -> None:
    """MuJoCo takes it for still: its speed is that from pose to pose."""

    def move(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.mocap_pos[0, 2] = lift * data.time
        angle = turn * data.time
        data.mocap_quat[0] = np.cos(angle / 2), 0, -np.sin(angle / 2), 0

    scene = attach(PADDLE.format(gravity=0.0, integrator="Euler"))
    qpos = [x, 0, z, 1, 0, 0, 0]
    with pytest.warns(ImpactWarning, match=told):
        trajectory = run(scene, duration=0.01, qpos=qpos, controller=move)
    assert kinds(trajectory)[0] == FAST


def test_a_mocap_body_that_stays_is_no_excuse() -> None:
    """The energy of a tumbling body beside it is judged as ever."""
    xml = BOX.format(integrator="Euler").replace(
        "</worldbody>",
        '<body pos="2 0 0" mocap="true"><geom size=".1"/></body></worldbody>',
    )
    with pytest.warns(ImpactWarning, match="energy grew by [0-9.]+ % of the largest"):
        assert kinds(run(attach(xml), duration=1.0)) == [ENERGY]
