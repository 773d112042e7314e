"""Stops of joints and tendons are rigid while an impact pushes them, and never pull."""

import itertools

import mujoco
import numpy as np
import pytest
from scenes import INTEGRATORS, header

import mujoco_impact

# Closed form of the rigid stop: masses of striker and bob [kg], arm of the bob [m],
# restitution, speed of the striker before and after [m/s]; the bob stays. An elastic
# ball that strikes a bob at its stop comes back as from a wall.
ROWS = [
    (0.2, 0.2, 0.5, 1.0, 0.5, -0.5),
    (0.2, 0.2, 0.5, 1.0, 1.0, -1.0),
    (0.2, 0.2, 0.5, 1.0, 2.0, -2.0),
    (0.2, 0.2, 0.5, 0.8, 1.0, -0.8),
    (0.2, 0.2, 0.5, 0.5, 2.0, -1.0),
]

# the striker comes along x and meets a ball at the origin
SCENE = """
<mujoco>
  <option timestep="{timestep}" integrator="{integrator}" gravity="{gravity}"/>
  <default><geom size=".02" mass=".2" condim="1"/></default>
  <worldbody>
    <site name="wall" pos="-.5 0 .2"/>
    <body pos="-.0407 0 0"><joint type="slide" axis="1 0 0"/><geom/></body>
    {struck}
  </worldbody>
  <tendon>{tendon}</tendon>
</mujoco>
"""

# a bob that is pushed along x turns by a negative angle about y
HINGE = """
<body pos="0 0 .5">
  <joint axis="0 1 0" {}/><geom pos="0 0 -.5"/>
</body>"""
SLIDE = '<body><joint name="slide" type="slide" axis="1 0 0" {}/><geom/></body>'
# hangs along z when swung by 30 degrees out of the pose in which it is written
BALL = """
<body pos="0 0 .5" euler="0 {} 0">
  <joint type="ball" range="0 30"/><geom pos="0 0 -.5"/>
</body>"""
FREE = '<body><freejoint/><geom/><site name="held" pos="0 0 0"/></body>'
STRING = '<spatial {}><site site="wall"/><site site="held"/></spatial>'
FIXED = '<fixed {}><joint joint="slide" coef="-2"/></fixed>'
LENGTH = np.hypot(0.5, 0.2)

KINDS = {
    "hinge": (HINGE.format('range="0 90"'), ""),
    "hinge at its upper end": (
        HINGE.format('range="-90 0"').replace("0 1 0", "0 -1 0"),
        "",
    ),
    "slide": (SLIDE.format('range="-1 0"'), ""),
    "slide with a margin": (SLIDE.format('range="-1 .01" margin=".01"'), ""),
    "ball": (BALL.format(30), ""),
    "fixed tendon": (SLIDE.format(""), FIXED.format('range="0 1"')),
}


def scene(
    kind, *, integrator="Euler", timestep=2e-3, gravity="0 0 -9.81", **settings
):  # fmt: skip
    struck, tendon = KINDS[kind] if isinstance(kind, str) else kind
    xml = SCENE.format(
        timestep=timestep,
        integrator=integrator,
        gravity=gravity,
        struck=struck,
        tendon=tendon,
    )
    model = mujoco_impact.attach(xml, **settings).compile()
    data = mujoco.MjData(model)
    if kind == "ball":
        mujoco.mju_axisAngle2Quat(data.qpos[1:5], [0, -1, 0], np.radians(30))
    return model, data


def strike(model, data, speed=1.0, time=0.008):
    """Steps until the impact is over, before anything else can happen."""
    data.qvel[0] = speed
    for _ in range(round(time / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert header(model, data).count > 0
    return data.qvel


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("row", ROWS)
def test_a_bob_at_its_stop_is_a_wall(row, integrator):
    striker, bob, arm, restitution, before, after = row
    struck = HINGE.format('range="0 90"').replace(".5", str(arm))
    struck = struck.replace("<geom", f'<geom mass="{bob}"')
    model, data = scene((struck, ""), integrator=integrator, restitution=restitution)
    assert model.body_mass[1] == striker
    velocity = strike(model, data, before, time=0.02)
    assert velocity[0] == pytest.approx(after, abs=1e-9)
    assert velocity[1] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_stop_holds(kind, integrator):
    model, data = scene(kind, integrator=integrator, gravity="0 0 0")
    velocity = strike(model, data)
    np.testing.assert_allclose(velocity[0], -1, atol=1e-9)
    np.testing.assert_allclose(velocity[1:], 0, atol=1e-9)


def arm_at_its_stops(random, slides, joints=4):
    """A random arm with a ball at its end, each joint at one end of its range."""
    open_bodies = ""
    for i in range(joints):
        axis = " ".join(map(str, random.normal(size=3)))
        low, high = (0, 1) if random.random() < 0.5 else (-1, 0)
        kind = "slide" if random.random() < slides else "hinge"
        offset = " ".join(map(str, random.uniform(0.1, 0.3, 3)))
        open_bodies += f"""
        <body pos="{offset if i else "0 0 0"}">
          <joint name="j{i}" type="{kind}" axis="{axis}" range="{low} {high}"/>
          <geom size=".03" pos="{offset}" mass="{random.uniform(0.1, 1)}"
                contype="0" conaffinity="0"/>"""
    coefficients = "".join(
        f'<joint joint="j{i}" coef="{random.normal()}"/>' for i in range(joints)
    )
    return f"""
    <mujoco>
      <compiler angle="radian"/>
      <option timestep=".001" gravity="0 0 0"/>
      <worldbody>
        {open_bodies}<geom name="tip" size=".03" mass=".3" condim="1"/>
        {"</body>" * joints}
        <body name="striker"><freejoint/>
          <geom name="striker" size=".03" mass=".3" condim="1"/></body>
      </worldbody>
      <tendon>
        <fixed range="0 1">{coefficients}</fixed>
      </tendon>
    </mujoco>"""


def struck_arm(random, speed, slides=0.25, time=5e-4, **settings):
    """The arm, and the normal row of the ball that is at its tip in that time."""
    xml = arm_at_its_stops(random, slides)
    model = mujoco_impact.attach(xml, geoms=["tip", "striker"], **settings).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    towards = random.normal(size=3)
    towards /= np.linalg.norm(towards)
    tip = data.geom("tip").xpos
    data.qpos[-7:-4] = tip - (0.06 + speed * time) * towards
    data.qvel[-6:-3] = speed * towards
    mujoco.mj_forward(model, data)
    row = np.zeros((2, 3, model.nv))
    for side, name in enumerate(("striker", "tip")):
        mujoco.mj_jac(model, data, row[side], None, tip, model.geom(name).bodyid[0])
    return model, data, towards @ (row[1] - row[0])


def after_by_enumeration(model, data, normal, restitution):
    """Velocity after the impact, with the only set of stops that push and do not give.

    All joints and the tendon stand at one end of their range, which is 0.
    """
    inverse = np.zeros((model.nv, model.nv))
    mujoco.mj_solveM(model, data, inverse, np.eye(model.nv))
    stops = np.zeros((model.njnt, model.nv))
    for i in range(model.njnt - 1):
        stops[i, i] = 1 if model.jnt_range[i, 0] == 0 else -1
    stops[-1, : model.njnt - 1] = data.ten_J[: model.njnt - 1]
    found = []
    for number in range(len(stops) + 1):
        for held in itertools.combinations(range(len(stops)), number):
            rows = stops[list(held)]
            A = rows @ inverse @ rows.T
            if number > 0 and np.linalg.cond(A) > 1e10:
                continue
            kick = inverse @ normal
            per_impulse = -np.linalg.solve(A, rows @ kick) if number else np.zeros(0)
            kick = kick + inverse @ rows.T @ per_impulse
            impulse = -(1 + restitution) * (normal @ data.qvel) / (normal @ kick)
            if (per_impulse >= 0).all() and (stops @ kick >= -1e-12).all():
                found.append(data.qvel + impulse * kick)
    # several sets may say the same
    np.testing.assert_allclose(found, [found[0]] * len(found), atol=1e-9)
    return found[0]


@pytest.mark.parametrize("restitution", [1, 0.6])
@pytest.mark.parametrize("seed", range(40))
def test_stops_push_or_let_go_as_complementarity_says(seed, restitution):
    speed = 0.01
    random = np.random.default_rng(seed)
    model, data, normal = struck_arm(random, speed, restitution=restitution)
    before = data.qvel.copy()
    expected = after_by_enumeration(model, data, normal, restitution)
    mujoco.mj_step(model, data)
    assert header(model, data).count == 1
    # the arm turns by a hundred-thousandth while the impact lasts
    np.testing.assert_allclose(data.qvel, expected, atol=1e-4 * speed)
    assert np.abs(data.qvel - before).max() > 0.1 * speed


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_taut_string_passes_the_impulse_on(integrator):
    """Two free balls on a string are as heavy as both, and no momentum is lost."""
    behind = '<body pos="-.5 0 0"><freejoint/><geom/><site name="behind"/></body>'
    string = STRING.format('range="0 .5"').replace("wall", "behind")
    model, data = scene((FREE + behind, string), integrator=integrator,
                        gravity="0 0 0")  # fmt: skip
    velocity = strike(model, data)
    along = velocity[[0, 1, 7]]
    np.testing.assert_allclose(along, [-1 / 3, 2 / 3, 2 / 3], atol=1e-9)
    np.testing.assert_allclose(np.delete(velocity, [0, 1, 7]), 0, atol=1e-9)
    assert along.sum() == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("timestep", [1e-5, 1e-4, 5e-4])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_stops_hold_against_pulses_of_many_steps(integrator, timestep):
    """A contact of 0.2 ms lasts for as many steps as it takes."""
    model, data = scene("hinge", integrator=integrator, timestep=timestep)
    velocity = strike(model, data, time=2e-3)
    np.testing.assert_allclose(velocity, [-1, 0], atol=1e-8)


@pytest.mark.parametrize("duration", ["paper", 0.02])
def test_stops_hold_against_waveforms(duration):
    model, data = scene("hinge", duration=duration)
    velocity = strike(model, data, time=0.1)
    np.testing.assert_allclose(velocity, [-1, 0], atol=1e-8)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize(
    ("limits", "speed"),
    [
        # away from both ends
        ('range="-45 45"', 1.0),
        # at the end from which the striker pushes it away
        ('range="-90 0"', 1.0),
        # at the end against which it is pushed, but limits are disabled
        ('range="0 90"', 1.0),
    ],
    ids=["away", "pulled", "disabled"],
)
def test_a_stop_that_does_not_hold_changes_no_bit(limits, speed, integrator):
    states = []
    for limit in (limits, ""):
        model, data = scene((HINGE.format(limit), ""), integrator=integrator)
        if limits == 'range="0 90"':
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
        strike(model, data, speed)
        states.append(np.concatenate([data.qpos, data.qvel, data.plugin_state]))
    np.testing.assert_array_equal(*states)
    # as equal balls do
    assert states[0][2] == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_ball_bounces_off_one_that_lies_on_its_stop(integrator):
    """What presses a joint on its stop does not let it give way before the impact."""
    xml = """
    <mujoco>
      <option timestep=".002"/>
      <default><geom size=".02" mass=".2"/>
        <joint type="slide" axis="0 0 1"/></default>
      <worldbody>
        <body pos="0 0 .1"><joint/><geom/></body>
        <body><joint range="-1e-4 1"/><geom/></body>
      </worldbody>
    </mujoco>"""
    spec = mujoco.MjSpec.from_string(xml)
    spec.option.integrator = INTEGRATORS[integrator]
    model = mujoco_impact.attach(spec).compile()
    data = mujoco.MjData(model)
    # the lower ball sinks into its stop; the other one falls when it lies
    for _ in range(300):
        mujoco.mj_step(model, data)
        data.qpos[0] = data.qvel[0] = 0
    lies = data.qpos[1]
    assert -5e-4 < lies < -1e-4
    highest = -1.0
    for _ in range(250):
        mujoco.mj_step(model, data)
        if header(model, data).count == 1 and data.qvel[0] > 0:
            highest = max(highest, data.qpos[0])
    assert header(model, data).count >= 1
    # a step of 2 ms misses the top by up to g h²/2; RK4 sees the softness of the stop
    assert highest == pytest.approx(0, abs=4e-5)


@pytest.mark.parametrize(
    ("angle", "speed", "at_its_stop"),
    # at 1 m/s a contact lasts for .2 ms and pushes a free bob by some .2 mrad
    [(1e-7, 1, True), (1e-5, 1, True), (1e-4, 1, False), (0.01, 1, False)],
)
def test_a_joint_is_at_a_stop_that_it_reaches_while_the_impact_lasts(
    angle, speed, at_its_stop
):
    model, data = scene("hinge", gravity="0 0 0")
    data.qpos[1] = angle
    velocity = strike(model, data, speed, time=0.004)
    assert velocity[0] == pytest.approx(-speed if at_its_stop else 0, abs=1e-3)


def test_a_joint_that_leaves_its_stop_is_free():
    model, data = scene("hinge", gravity="0 0 0")
    data.qvel[1] = 0.2
    velocity = strike(model, data, time=0.002)
    # the balls exchange their velocities, but for the arc of the bob
    assert velocity[0] == pytest.approx(-0.1, abs=1e-3)


def kinetic_energy(model, data, velocity):
    momentum = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, momentum, velocity)
    return momentum @ velocity / 2


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_energy_never_grows(integrator):
    """Arms whose joints leave their stops, come to them or lie on them are struck."""
    held = 0
    for seed in range(60):
        random = np.random.default_rng(seed)
        # of slides, so that time alone changes no velocity
        model, data, _ = struck_arm(random, 1.0, slides=1, time=1e-7)
        model.opt.integrator = INTEGRATORS[integrator]
        data.qvel[:4] = random.normal(size=4) * random.choice([0, 1e-3, 0.3])
        before, after = data.qvel.copy(), []
        for limits in (True, False):
            model.jnt_limited[:-1] = model.tendon_limited[:] = limits
            start = mujoco.MjData(model)
            start.qpos[:], start.qvel[:] = data.qpos, before
            mujoco.mj_step(model, start)
            assert header(model, start).count == 1
            after.append(start.qvel.copy())
        energies = [kinetic_energy(model, data, v) for v in (before, after[0])]
        assert energies[1] <= energies[0] * (1 + 1e-9)
        held += np.abs(after[0] - after[1]).max() > 1e-3
    assert held > 20


@pytest.mark.parametrize("integrator", [name for name in INTEGRATORS if name != "RK4"])
def test_a_bob_on_its_way_out_of_a_soft_stop_is_struck_as_if_it_were_free(integrator):
    """MuJoCo's limit, which still pushes it, does not answer in the same step."""
    model, data = scene("slide", integrator=integrator, gravity="0 0 0")
    data.qpos[:], data.qvel[:] = 1e-3, [1, -0.5]
    while header(model, data).count == 0:
        mujoco.mj_step(model, data)
    assert data.qpos[1] > 0
    np.testing.assert_allclose(data.qvel.sum(), 0.5, atol=1e-9)
    np.testing.assert_allclose(data.qvel, [-0.5, 1], atol=1e-9)


@pytest.mark.parametrize("timestep", [1e-4, 2e-3])
@pytest.mark.parametrize("gap", [0, 2e-5, 5e-4])
def test_what_a_string_pulls_strikes_on_like_a_row_of_three(gap, timestep):
    """A ball, two on a string, and one that the second of them touches or reaches."""
    behind = f"""
    <body pos="-.5 0 0"><freejoint/><geom/><site name="behind"/></body>
    <body pos="{-0.46 + gap} 0 0"><freejoint/><geom/></body>"""
    string = STRING.format('range="0 .5"').replace("wall", "behind")
    row = f"""
    <body><freejoint/><geom mass=".4"/></body>
    <body pos="{0.04 + gap} 0 0"><freejoint/><geom/></body>"""
    ways, after = [], []
    for struck, balls in (((FREE + behind, string), 4), ((row, ""), 3)):
        model, data = scene(struck, gravity="0 0 0", timestep=timestep)
        start = data.qpos.copy()
        velocity = strike(model, data, time=4e-3)
        ways.append((data.qpos - start)[[0, 1, 8, 15][:balls]])
        after.append(velocity[[0, 1, 7, 13][:balls]])
    # to the tolerance of the law
    as_in_row = [0, 1, 1, 2]
    np.testing.assert_allclose(after[0], after[1][as_in_row], atol=1e-6)
    np.testing.assert_allclose(ways[0], ways[1][as_in_row], atol=1e-8)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_an_arm_whose_shoulder_is_at_its_stop_is_an_arm_without_a_shoulder(integrator):
    """Its joint does not move in the impact, nor do forces of its speed arise."""
    arm = """
    <body pos="0 0 .3">
      {joint}<geom type="capsule" fromto="0 0 0 -.2 0 0" contype="0" conaffinity="0"/>
      <body pos="-.2 0 0">
        <joint axis="0 1 0" pos="0 0 0"/>
        <geom type="capsule" fromto="0 0 0 .2 0 -.3" contype="0" conaffinity="0"/>
        <geom pos=".2 0 -.3"/>
      </body>
    </body>"""
    shoulder = '<joint axis="0 1 0" range="0 90"/>'
    after = []
    for joint in (shoulder, ""):
        model, data = scene((arm.format(joint=joint), ""), integrator=integrator,
                            gravity="0 0 0")  # fmt: skip
        if joint:
            # so that MuJoCo's limit holds it, and hardly moves it
            data.qpos[1] = -1e-9
        data.qvel[0] = 3.0
        while header(model, data).count == 0:
            mujoco.mj_step(model, data)
        after.append(data.qvel[[0, -1]].copy())
    assert after[0][1] < -5
    assert after[0][0] == pytest.approx(after[1][0], rel=1e-6)
    # for the rest of the step the limit is MuJoCo's, and soft to what the elbow pulls
    assert after[0][1] == pytest.approx(after[1][1], rel=1.5e-3)
