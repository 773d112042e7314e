"""Impacts on bodies that the floor and others hold, against the Hertz problem."""

from functools import cache

import mujoco
import numpy as np
import pytest
from held_balls import STEEL, Balls, lying, strike, truth, worst_error

RADIUS = 0.02
SPEED = 2.43  # of a fall of .3 m

# An impact may begin anywhere in a step: early, late, and so late that it outlasts it.
MOMENTS = (0.02, 0.35, 0.65, 0.98)

BOUND = 1e-2  # of the speed


def on_top(
    radius=(RADIUS, RADIUS), density=(1, 1), aside: float = 0.0, **options
) -> Balls:
    """A ball that falls on one that lies on the floor."""
    low, high = radius
    reach = low + high
    up = low + reach * np.sqrt(1 - aside**2)
    return Balls(
        np.array(radius),
        np.array([[0, 0, low], [aside * reach, 0, up]]),
        np.array([[0, 0, 0], [0, 0, -SPEED]]),
        density=np.array(density),
        **options,
    )


def stack(number: int, side: int | None = None, friction: float = 0.0) -> Balls:
    """Balls on top of each other, struck from above, or from the side."""
    place = np.zeros((number + 1, 3))
    place[:, 2] = RADIUS * (1 + 2 * np.arange(number + 1))
    velocity = np.zeros((number + 1, 3))
    velocity[-1] = [0, 0, -SPEED]
    if side is not None:
        place[-1] = [-2 * RADIUS, 0, place[side, 2]]
        velocity[-1] = [SPEED, 0, 0]
    return Balls(
        np.full(number + 1, RADIUS),
        place,
        velocity,
        pair_friction=friction,
        floor_friction=friction,
    )


def row(number: int, density=None, **options) -> Balls:
    """Balls on a table, a micrometre apart, struck by one along the row."""
    place = np.zeros((number, 3))
    place[:, 2] = RADIUS
    place[:-1, 0] = (2 * RADIUS + 1e-6) * np.arange(number - 1)
    place[-1, 0] = -2 * RADIUS
    velocity = np.zeros((number, 3))
    velocity[-1, 0] = SPEED
    return Balls(
        np.full(number, RADIUS),
        place,
        velocity,
        density=np.ones(number) if density is None else np.array(density),
        **options,
    )


# Off its centre a ball turns the line of contact while it presses: by .01 rad if it is
# of steel, which an impact does not follow. A hundred times as stiff, a sixth of it.
HARD = 100 * STEEL

CASES = {
    "on one": on_top(),
    "heavy on light": on_top(density=(0.3, 1)),
    "small on large": on_top(radius=(RADIUS, RADIUS / 2)),
    "aside, hard": on_top(aside=0.5, young=HARD),
    "aside with friction, hard": on_top(
        aside=0.7, young=HARD, pair_friction=0.3, floor_friction=0.3
    ),
    "on a stack of two": stack(2),
    "on a stack of three": stack(3),
    "a stack from the side": stack(3, side=1),
    "a stack from the side with friction": stack(3, side=2, friction=0.3),
    "a row of three": row(3),
    "a row of five": row(5),
    "a row of unequal ones": row(4, density=(1, 3, 0.3, 1)),
    "a row by one that rolls": row(
        3, rolls=True, pair_friction=0.3, floor_friction=0.3
    ),
}


@cache
def true_motion(case: str):
    return truth(CASES[case])


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
@pytest.mark.parametrize("case", CASES)
def test_what_lies_is_struck_as_hertz_has_it(case, cone, integrator):
    """Its weight is borne: it was met as if it fell, at .02 m/s and more.

    MuJoCo bears it until the step ends, also where the impact has lifted it. That is
    what is left: up to g h / 2 = .01 m/s.
    """
    balls = CASES[case]
    model, rest = lying(balls, integrator, cone, steps=500)
    for moment in MOMENTS:
        data = mujoco.MjData(model)
        mujoco.mj_copyData(data, model, rest)
        _, after = strike(balls, model, data, moment)
        assert worst_error(balls, after, true_motion(case)) < BOUND


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
@pytest.mark.parametrize("steps", [0, 1, 4])
@pytest.mark.parametrize(
    "case", ["on one", "small on large", "on a stack of two", "on a stack of three"]
)
def test_what_still_sinks_into_the_floor_is_struck_so_too(case, steps, integrator):
    """Bodies that have just been put there: MuJoCo's floor gives way for 50 ms.

    The truth is that of bodies which move as they do then.
    """
    balls = CASES[case]
    model, rest = lying(balls, integrator, "pyramidal", steps)
    for moment in MOMENTS:
        data = mujoco.MjData(model)
        mujoco.mj_copyData(data, model, rest)
        meeting, after = strike(balls, model, data, moment)
        assert worst_error(balls, after, truth(meeting)) < BOUND
