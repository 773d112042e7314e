"""The impacts of a step, one world a thread: what closes first comes first."""

import warp as wp

from mujoco_impact.warp.closing import NEVER, closing_time, resting_gravity
from mujoco_impact.warp.deliver import (
    add_impulses,
    commit,
    count_forces_meanwhile,
    press_out_dents,
    set_busy,
)
from mujoco_impact.warp.hertz import solve_single
from mujoco_impact.warp.island import SAME_IMPACT, gather, make_rows
from mujoco_impact.warp.law import Span, integrate
from mujoco_impact.warp.memory import Bodies, Contacts, Pairs, Paths, World
from mujoco_impact.warp.passivity import keep_energy
from mujoco_impact.warp.path import begin_path

wp.set_module_options({"enable_backward": False})

OVERFLOW = wp.constant(1)
UNFINISHED = wp.constant(2)
INVALID = wp.constant(4)


@wp.struct
class Outcome:
    """What the impacts of one round took."""

    steps: int  # of the law
    flag: int  # what went wrong


@wp.func
def solve(
    pairs: Pairs, z: Contacts, w: int, n: int, left: float, h: float, most_steps: int
) -> Span:
    """Impulses, moments and onsets of an impact; of one contact in closed form."""
    if n > 1:
        tolerance = pairs.tolerance[z.pair[0, w]]
        span = integrate(z, w, n, tolerance, left, SAME_IMPACT * h, most_steps)
        keep_energy(z, w, n)
        return span
    single = solve_single(z.K[0, w], 1.0 / z.W[0, 0, w], z.closing[0, w], z.e[0, w])
    z.P[0, w] = single.impulse
    z.M[0, w] = single.moment
    z.onset[0, w] = 0.0
    alone = Span()
    alone.time = single.duration
    alone.steps = int(1)
    alone.ended = True
    return alone


@wp.func
def foresee(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    world: World,
    w: int,
    h: float,
    pressing_gravity: float,
    number: int,
) -> None:
    """When each pair closes that round `number` struck; at first, with 0, all are."""
    for p in range(pairs.first.shape[0]):
        one = paths.round[pairs.first[p], w] == number
        two = paths.round[pairs.second[p], w] == number
        if one or two:
            world.closing_time[p, w] = closing_time(
                bodies, pairs, paths, p, w, h, pressing_gravity
            )


@wp.func
def first_to_close(pairs: Pairs, world: World, w: int) -> int:
    """The pair that closes first; −1 if none does."""
    first = int(-1)
    t = float(NEVER)
    for p in range(pairs.first.shape[0]):
        if world.closing_time[p, w] < t:
            t = world.closing_time[p, w]
            first = p
    return first


@wp.func
def collide(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    z: Contacts,
    world: World,
    w: int,
    h: float,
    first: int,
    number: int,
    most_steps: int,
) -> Outcome:
    """The impact that the pair `first` begins, in round `number`."""
    t = world.closing_time[first, w]
    outcome = Outcome()
    n = gather(bodies, pairs, paths, z, world, first, w, t, h, number)
    if n > z.pair.shape[0]:
        outcome.flag = OVERFLOW
        n = z.pair.shape[0]
    make_rows(bodies, pairs, paths, z, n, w, t)
    span = solve(pairs, z, w, n, h - t, h, most_steps)
    outcome.steps = span.steps
    if not span.ended:
        outcome.flag = outcome.flag | UNFINISHED
    press_out_dents(bodies, pairs, paths, z, w, n, wp.max(span.time, h - t))
    count_forces_meanwhile(z, w, n)
    if not add_impulses(bodies, pairs, paths, z, w, n, t, span.time, h):
        # what does not push is left for the next step
        set_busy(bodies, paths, pairs.first[first], w, h)
        set_busy(bodies, paths, pairs.second[first], w, h)
    return outcome


@wp.kernel
def resolve(
    bodies: Bodies,
    pairs: Pairs,
    paths: Paths,
    z: Contacts,
    world: World,
    timestep: wp.array[float],
    gravity: wp.array[wp.vec3],
    weightless: int,
    pressing_gravity: float,
    implicit: int,
    most_steps: int,
    most_impacts: int,
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    sensordata: wp.array2d[float],
    sensor: wp.array[int],
    flags: wp.array[int],
) -> None:
    """Finds and solves the impacts of the step that MuJoCo has just taken.

    `world` holds the state before that step, `qpos` and `qvel` the state after it.
    """
    w = wp.tid()
    h = timestep[w % timestep.shape[0]]
    g = gravity[w % gravity.shape[0]]
    if weightless == 1:
        g = wp.vec3(0.0)
    pressing = resting_gravity(g, pressing_gravity)
    for x in range(bodies.kind.shape[0]):
        begin_path(bodies, paths, x, w, world.qpos, world.qvel, qvel, h, g)
    for p in range(pairs.first.shape[0]):
        world.member[p, w] = 0
    number = int(0)
    steps = int(0)
    flag = int(0)
    going = bool(True)
    while going:
        foresee(bodies, pairs, paths, world, w, h, pressing, number)
        first = first_to_close(pairs, world, w)
        if first < 0:
            going = False
        elif number >= most_impacts or steps >= most_steps:
            flag = flag | UNFINISHED
            going = False
        else:
            number += 1
            outcome = collide(
                bodies, pairs, paths, z, world, w, h, first, number, most_steps - steps
            )
            steps += outcome.steps
            flag = flag | outcome.flag
    for x in range(bodies.kind.shape[0]):
        commit(bodies, paths, x, w, h, implicit, qpos, qvel)
        if not wp.isfinite(wp.length(paths.P[x, w])):
            flag = flag | INVALID
    # MuJoCo Warp has zeros there, which are not what the sensor would say
    for i in range(sensor.shape[0]):
        sensordata[w, sensor[i]] = wp.NAN
    world.impacts[w] = world.impacts[w] + number
    world.law_steps[w] = world.law_steps[w] + steps
    if flag != 0:
        world.flag[w] = world.flag[w] | flag
        wp.atomic_or(flags, 0, flag)
