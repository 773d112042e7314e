"""What the law makes of an impact, a scene makes of it, too.

The rows are those of test_friction_truth.py; rods are Keller's problem with the inertia
and the pose of the body when it strikes. Bodies fly for .37 of a step before.
"""

import keller
import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from spatial import ball, rack
from test_friction_truth import of, rows

import mujoco_impact

H = 0.002
FLIGHT = 0.37 * H
INTEGRATORS = ["Euler", "implicitfast", "RK4"]


def scene(bodies: str, integrator: str, mu: float, e: float):
    """Bodies without gravity, above a floor."""
    xml = f"""
    <mujoco>
      <option timestep="{H}" integrator="{integrator}" gravity="0 0 0" cone="elliptic"/>
      <default><geom friction="{mu}"/></default>
      <worldbody>{bodies}</worldbody>
    </mujoco>"""
    model = mujoco_impact.attach(xml, restitution=e, speed=20).compile()
    return model, mujoco.MjData(model)


def of_balls(bodies, radius: float, integrator: str, mu: float, e: float) -> np.ndarray:
    """Velocities and spins after the first of the bodies strikes, (n, 6)."""
    xml = "".join(
        f'<body pos="{body.position[0]:.17g} {body.position[1]:.17g} 0"><freejoint/>'
        f'<geom size="{radius}" mass="{body.mass}"/></body>'
        for body in bodies
    )
    model, data = scene(xml, integrator, mu, e)
    data.qpos[:3] -= FLIGHT * bodies[0].velocity
    data.qvel[:] = np.concatenate([[*body.velocity, *body.spin] for body in bodies])
    # a rack takes longer than what is left of the first step
    mujoco.mj_step(model, data, 2)
    return data.qvel.reshape(-1, 6)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_ball_between_two(integrator):
    for row in rows("three_balls"):
        R, mass = 0.02, 0.17
        half = np.radians(row["half_angle_deg"])
        bodies = [ball(mass, R, [0, 0, 0], [1, 0, 0], [0, 0, row["spin_z"]])] + [
            ball(mass, R, 2 * R * np.array([np.cos(a), np.sin(a), 0]))
            for a in (half, -half)
        ]
        after = of_balls(bodies, R, integrator, row["mu"], row["e"])
        expected = [of(row, f"v{n}_x v{n}_y w{n}_z") for n in "abc"]
        error = np.abs(after[:, [0, 1, 5]] - expected) * [1, 1, R]
        assert error.max() < 2e-5  # of 1 m/s, as in the law


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_the_break_of_a_rack(integrator):
    table = rows("rack_15")[16:32]
    speed, offset, mu, e = of(table[0], "v_cue offset_over_2R mu e")
    after = of_balls(rack(speed, offset).bodies, 0.028575, integrator, mu, e)
    expected = [of(row, "vx vy wz") for row in table]
    error = np.abs(after[:, [0, 1, 5]] - expected) * [1, 1, 0.028575]
    assert error.max() < 1e-4 * speed  # as in the law


GROUND = '<geom type="plane" size="5 5 .1"/>'


@pytest.mark.parametrize("row", rows("box_plane"))
def test_a_box_on_a_corner_an_edge_or_a_face(row):
    """Under RK4, for Euler's own free rotation of 17 rad/s is off by 2e-3."""
    half = np.array([0.05, 0.07, 0.04])
    geom = '<body><freejoint/><geom type="box" size=".05 .07 .04" mass="1"/></body>'
    model, data = scene(GROUND + geom, "RK4", row["mu"], row["e"])
    inertia = (half @ half - half**2) / 3
    turn = Rotation.from_quat(of(row, "qw qx qy qz"), scalar_first=True)
    spin = turn.inv().apply(of(row, "wx wy wz"))
    # back in time: with its spin turned around, it goes the way that it came
    start = mujoco.MjData(model)
    start.qpos[2:7] = [1, *turn.as_quat(scalar_first=True)]
    start.qvel[3:] = -spin
    model.opt.timestep = FLIGHT
    mujoco.mj_step(model, start)
    model.opt.timestep = H
    corners = (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1) * half
    touching = [0, 0, -turn.apply(corners)[:, 2].min()]
    data.qpos[:3] = touching - FLIGHT * of(row, "vx vy vz")
    data.qpos[3:] = start.qpos[3:]
    data.qvel[:] = [*of(row, "vx vy vz"), *-start.qvel[3:]]

    mujoco.mj_step(model, data)

    now = Rotation.from_quat(data.qpos[3:7], scalar_first=True)
    # angular momentum stays as it was after the impact
    L = now.apply(inertia * data.qvel[3:])
    L_after = turn.apply(inertia * turn.inv().apply(of(row, "wx1 wy1 wz1")))
    assert np.abs(data.qvel[:3] - of(row, "vx1 vy1 vz1")).max() < 1e-3
    assert 0.1 * np.abs(L - L_after).max() < 1e-3 * inertia.mean()


RADIUS, LENGTH = 0.02, 0.1


def lowest(shape: str, angle: float) -> np.ndarray:
    """Place of its lowest point from the centre, (x, z), turned about y by `angle`."""
    c, s = np.cos(angle), np.sin(angle)
    ends = LENGTH * np.array([[s, c], [-s, -c]])
    sides = RADIUS * np.array([[c, -s], [-c, s]])
    points = ends - [0, RADIUS]
    if shape == "box":
        points = (ends[:, None] + sides).reshape(-1, 2)
    return points[points[:, 1].argmin()]


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("shape", ["capsule", "box"])
def test_a_rod_that_strikes_the_ground_is_kellers_solution(shape, integrator):
    geom = {
        "capsule": f'type="capsule" size="{RADIUS} {LENGTH}"',
        "box": f'type="box" size="{RADIUS} .01 {LENGTH}"',
    }[shape]
    errors = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        mu, e = rng.choice([0.1, 0.3, 0.7]), rng.choice([0.3, 0.7, 1.0])
        angle, spin, slide = rng.uniform([-1.2, -10, -1], [1.2, 10, 1])
        model, data = scene(
            f"{GROUND}<body><freejoint/><geom {geom}/></body>", integrator, mu, e
        )
        mass = model.body_mass[1]
        # about y, which MuJoCo tells in the frame of the principal axes
        turn = Rotation.from_quat(model.body_iquat[1], scalar_first=True).as_matrix()
        pitch = turn[1] ** 2 @ model.body_inertia[1]
        x, z = arm = lowest(shape, angle)
        # of the point: v + w x r
        velocity = np.array([-1 - spin * x, slide + spin * z])
        if velocity[0] > -0.3:
            continue
        J = np.array([[0, 1, -x], [1, 0, z]])  # on x, z and the turn about y
        mobility = np.diag([1 / mass, 1 / mass, 1 / pitch])
        P = keller.impulses(*velocity, J @ mobility @ J.T, mu, e)
        expected = [slide, -1, spin] + mobility @ J.T @ P
        data.qpos[2] = -arm[1] + FLIGHT
        data.qpos[0] = -FLIGHT * slide
        before = angle - FLIGHT * spin
        data.qpos[3:] = [np.cos(before / 2), 0, np.sin(before / 2), 0]
        data.qvel[[0, 2, 4]] = [slide, -1, spin]
        mujoco.mj_step(model, data)
        error = np.abs(data.qvel[[0, 2, 4]] - expected) * [1, 1, LENGTH]
        errors.append(error.max() / -velocity[0])
    assert len(errors) > 30
    # a capsule touches in one point, in closed form; a box in two, at the tolerance of
    # simulations
    assert max(errors) < (1e-8 if shape == "capsule" else 2e-4)
    assert np.median(errors) < 1e-5
