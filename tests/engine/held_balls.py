"""Balls that lie on a floor and on each other, and what strikes them: scene and truth.

The truth is the Hertz problem with Coulomb friction, integrated in physical time by
scipy, with no code of the plugin: every contact, those of the floor included, pushes by
K y^1.5, and its friction is -mu F v / sqrt(v^2 + (1e-5 u)^2). Gravity is left out: in
the .2 ms that an impact lasts it changes speeds by 2 mm/s.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scenes import header
from scipy.integrate import solve_ivp

import mujoco_impact

STEEL, POISSON, DENSITY, GRAVITY, STEP = 2e11, 0.3, 7850.0, 9.81, 0.002
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Balls:
    """Balls above the floor z = 0; the last strikes the others.

    Attributes:
        radius: [m], shape (n,).
        place: Where they are when the last begins to touch [m], shape (n, 3).
        velocity: Then [m/s], shape (n, 3).
        rolls: Whether the last rolls along x.
        pair_friction: Coefficient between balls.
        floor_friction: And on the floor.
        density: Of each over that of steel, shape (n,).
        young: Young's modulus of all, and of the floor [Pa].
    """

    radius: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    rolls: bool = False
    pair_friction: float = 0.0
    floor_friction: float = 0.0
    density: np.ndarray | float = 1.0
    young: float = STEEL

    @property
    def mass(self) -> np.ndarray:
        return 4 / 3 * np.pi * DENSITY * self.density * self.radius**3

    @property
    def speed(self) -> float:
        return float(np.abs(self.velocity).max())

    @property
    def spin(self) -> np.ndarray:
        """Of the last [rad/s], world frame."""
        return self.rolls * np.array([0, self.velocity[-1, 0] / self.radius[-1], 0])

    @property
    def rough(self) -> bool:
        return self.pair_friction > 0 or self.floor_friction > 0

    def stiffness(self, radius: float) -> float:
        """K of a contact with this reduced radius [N/m^1.5]."""
        return 4 / 3 * self.young / (2 * (1 - POISSON**2)) * np.sqrt(radius)


@dataclass(frozen=True)
class Motion:
    """How balls move after an impact.

    Attributes:
        velocity: [m/s], shape (n, 3).
        spin: [rad/s], world frame, shape (n, 3).
        flight: How long what has left the floor has been falling since [s].
    """

    velocity: np.ndarray
    spin: np.ndarray
    flight: float = 0.0


class _Hertz:
    """Rates of places, velocities and spins of balls that press each other."""

    def __init__(self, balls: Balls) -> None:
        n, r = len(balls.radius), balls.radius
        self.balls, self.shape = balls, (3, n, 3)
        self.pairs = [
            (i, j, balls.stiffness(r[i] * r[j] / (r[i] + r[j])))
            for i, j in itertools.combinations(range(n), 2)
        ]

    def push(self, normal, depth, stiffness, slip, friction) -> np.ndarray:
        """The force on the body that the normal points to [N]."""
        slip = slip - (slip @ normal) * normal
        smooth = np.sqrt(slip @ slip + (1e-5 * self.balls.speed) ** 2)
        return stiffness * depth**1.5 * (normal - friction * slip / smooth)

    def __call__(self, _: float, state: np.ndarray) -> np.ndarray:
        balls, r = self.balls, self.balls.radius
        place, velocity, spin = state.reshape(self.shape)
        force, torque = np.zeros_like(place), np.zeros_like(place)
        for i, j, stiffness in self.pairs:
            way = place[j] - place[i]
            distance = np.linalg.norm(way)
            depth, n = r[i] + r[j] - distance, way / distance
            if depth > 0:
                turning = np.cross(r[i] * spin[i] + r[j] * spin[j], n)
                slip = velocity[j] - velocity[i] - turning
                f = self.push(n, depth, stiffness, slip, balls.pair_friction)
                force[[i, j]] += [-f, f]
                torque[[i, j]] -= np.outer([r[i], r[j]], np.cross(n, f))
        for i, depth in enumerate(r - place[:, 2]):
            if depth > 0:
                slip = velocity[i] - r[i] * np.cross(spin[i], UP)
                f = self.push(
                    UP, depth, balls.stiffness(r[i]), slip, balls.floor_friction
                )
                force[i] += f
                torque[i] -= r[i] * np.cross(UP, f)
        m = balls.mass[:, None]
        return np.concatenate(
            [velocity, force / m, torque / (0.4 * m * r[:, None] ** 2)]
        )

    def rates(self, time: float, state: np.ndarray) -> np.ndarray:
        return self(time, state).ravel()


def truth(balls: Balls) -> Motion:
    """What the impact leaves, a millisecond after it began."""
    hertz, n, u = _Hertz(balls), len(balls.radius), balls.speed
    depth = (balls.mass.max() * u**2 / balls.stiffness(balls.radius.max())) ** 0.4
    start = np.zeros(hertz.shape)
    start[:2] = balls.place, balls.velocity
    start[2, -1] = balls.spin
    solution = solve_ivp(
        hertz.rates,
        (0, 1e-3),
        start.ravel(),
        method="Radau" if balls.rough else "DOP853",
        rtol=1e-7,
        atol=1e-7 * np.repeat([depth, u, u / balls.radius.min()], 3 * n),
        first_step=1e-3 * depth / u,
        max_step=0.5 * depth / u,
    )
    assert solution.status == 0, solution.message
    _, velocity, spin = solution.y[:, -1].reshape(hertz.shape)
    return Motion(velocity, spin)


def lying(
    balls: Balls, integrator: str, cone: str, steps: int
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The scene after so many steps in which the last ball is out of the way."""

    def contact(friction: float) -> str:
        return f'condim="{3 if friction else 1}" friction="{max(friction, 1e-5)}"'

    bodies = "".join(
        f'<body pos="{x!r} {y!r} {z!r}"><freejoint/><geom size="{radius!r}" '
        f'mass="{mass!r}" {contact(balls.pair_friction)}/></body>'
        for (x, y, z), radius, mass in zip(
            *(a.tolist() for a in (balls.place, balls.radius, balls.mass)), strict=True
        )
    )
    xml = f"""
    <mujoco>
      <option timestep="{STEP}" integrator="{integrator}" cone="{cone}"/>
      <worldbody>
        <geom type="plane" size="5 5 .1" priority="1" {contact(balls.floor_friction)}/>
        {bodies}
      </worldbody>
    </mujoco>"""
    model = mujoco_impact.attach(xml, restitution=1.0, young=balls.young).compile()
    data = mujoco.MjData(model)
    data.qpos[-7] -= 1.0
    mujoco.mj_step(model, data, steps)
    return model, data


def strike(
    balls: Balls, model: mujoco.MjModel, data: mujoco.MjData, moment: float
) -> tuple[Balls, Motion]:
    """Lets the last ball strike, at this part of the next step.

    What it strikes is where MuJoCo's softness lets it be, so it aims at that.

    Returns:
        The balls with their velocities as they meet, and how they move right after it.
    """
    n = len(balls.radius)
    place, speed = data.qpos.reshape(n, 7), data.qvel.reshape(n, 6)
    # the path of MuJoCo's bodies is half a step ahead of their velocity
    lag = 0.0 if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else STEP / 2
    tau = moment * STEP
    mujoco.mj_fwdPosition(model, data)
    # geom 0 is the floor; what no contact bears from below falls, on its path
    borne = [contact.geom[1] - 1 for contact in data.contact if contact.exclude == 0]
    fall = np.full((n, 1), GRAVITY)
    fall[borne] = 0.0
    velocity = balls.velocity.copy()
    velocity[:-1] = speed[:-1, :3] - fall[:-1] * (lag + tau) * UP
    away = np.linalg.norm(balls.place[:-1] - balls.place[-1], axis=1)
    goal = int(np.argmin(away - balls.radius[:-1]))
    moved = place[goal, :3] + tau * (velocity[goal] + fall[goal] * tau / 2 * UP)
    rolls = balls.place[-1, 2] < 1.001 * balls.radius[-1]
    weight = 0.0 if rolls else GRAVITY
    place[-1, :3] = balls.place[-1] + moved - balls.place[goal]
    place[-1, :3] -= tau * (balls.velocity[-1] + weight * tau / 2 * UP)
    place[-1, 3:] = 1, 0, 0, 0
    speed[-1] = [*(balls.velocity[-1] + weight * (lag + tau) * UP), *balls.spin]
    before = header(model, data).count
    steps = 0
    while header(model, data).count == before or header(model, data).active:
        mujoco.mj_step(model, data)
        steps += 1
        assert steps < 4
    spin = np.zeros((n, 3))
    for i in range(n):
        mujoco.mju_rotVecQuat(spin[i], speed[i, 3:], place[i, 3:])
    left = Motion(speed[:, :3].copy(), spin, steps * STEP - tau - lag)
    return replace(balls, velocity=velocity), left


def worst_error(balls: Balls, left: Motion, right: Motion) -> float:
    """The largest error of a velocity, or of a spin at the surface, in speeds."""
    velocity = left.velocity.copy()
    velocity[right.velocity[:, 2] > GRAVITY * STEP, 2] += GRAVITY * left.flight
    slide = np.abs(velocity - right.velocity).max()
    turn = np.abs(balls.radius[:, None] * (left.spin - right.spin)).max()
    return float(max(slide, turn)) / balls.speed
