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
    # two stops that hold the same are told apart by 1e-10 of their inertia
    assert velocity[0] == pytest.approx(after, abs=1e-9)
    assert velocity[1] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_stop_holds(kind, integrator):
    model, data = scene(kind, integrator=integrator, gravity="0 0 0")
    velocity = strike(model, data)
    np.testing.assert_allclose(velocity[0], -1, atol=1e-9)
    np.testing.assert_allclose(velocity[1:], 0, atol=1e-9)


def arm_at_its_stops(random, joints=4):
    """A random arm with a ball at its end, each joint at one end of its range."""
    open_bodies = ""
    for i in range(joints):
        axis = " ".join(map(str, random.normal(size=3)))
        low, high = (0, 1) if random.random() < 0.5 else (-1, 0)
        kind = "slide" if random.random() < 0.25 else "hinge"
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


def struck_arm(random, speed, **settings):
    """The arm, and the normal row of the ball that comes towards its tip."""
    xml = arm_at_its_stops(random)
    model = mujoco_impact.attach(xml, geoms=["tip", "striker"], **settings).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    towards = random.normal(size=3)
    towards /= np.linalg.norm(towards)
    tip = data.geom("tip").xpos
    data.qpos[-7:-4] = tip - (0.06 + 0.5 * speed * model.opt.timestep) * towards
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
