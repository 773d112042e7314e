"""Random scenes of every shape: a short sweep, and that it can tell what breaks."""

import copy
import dataclasses

import mujoco
import numpy as np
import pytest
from judged import violations

from mujoco_impact_lab.stress import DEFAULTS, OURS, SHAPES, judge, shrunk, sweep
from mujoco_impact_lab.stress.case import INTEGRATORS
from mujoco_impact_lab.stress.promises import Invariant
from mujoco_impact_lab.stress.shapes import Case, Evidence, Tree, case_of, scene_of
from mujoco_impact_lab.stress.shapes.case import FLOORS, JOINTS
from mujoco_impact_lab.stress.shapes.case import SHAPES as GEOMS
from mujoco_impact_lab.stress.shapes.invariants import GROWTH
from mujoco_impact_lab.stress.shapes.stretches import stretches

BY_NAME = {invariant.name: invariant for invariant in SHAPES.invariants}

SEEDS = range(160, 220)

BALL = Case(
    seed=1,
    trees=(Tree(number=0, joint="free", shapes=("sphere",), links=1),),
    floor="plane",
    size=0.1,
    offset=0.0,
    density=1000.0,
    mass_ratio=1.0,
    gravity=9.81,
    restitution=1.0,
    condim=1,
    cone="pyramidal",
    jacobian="dense",
    integrator="Euler",
    timestep=2e-3,
    pace=0.3,
    spin=0.3,
    clearance=0.02,
    steps=60,
)
"""A ball that bounces on a plane: nothing is the matter with it."""


@pytest.fixture(scope="module")
def outcomes():
    return sweep(SEEDS, family=SHAPES, methods=(OURS,))


@pytest.mark.parametrize("name", BY_NAME)
def test_random_shapes_keep_their_promises(outcomes, name):
    assert not violations(outcomes, name)


def test_the_sample_is_worth_judging(outcomes):
    assert not [outcome.failure for outcome in outcomes if outcome.failure]
    assert sum(outcome.impacts > 0 for outcome in outcomes) > 30
    cases = [outcome.case for outcome in outcomes]
    trees = [tree for case in cases for tree in case.trees]
    assert {case.floor for case in cases} == set(FLOORS)
    assert {case.integrator for case in cases} == set(INTEGRATORS)
    assert {tree.joint for tree in trees} == set(JOINTS)
    assert {shape for tree in trees for shape in tree.shapes} == set(GEOMS)
    judged = {v.invariant for outcome in outcomes for v in outcome.verdicts}
    assert judged == set(BY_NAME)


def test_a_seed_gives_the_same_verdicts_again(outcomes):
    assert sweep(SEEDS[:6], family=SHAPES, methods=(OURS,)) == outcomes[:6]


# --- the measures


@pytest.mark.parametrize("floor", ["plane", "tilted plane", "box"])
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("method", [OURS, DEFAULTS])
def test_a_ball_on_a_flat_floor_keeps_every_promise(floor, integrator, method):
    """What the measures make of a scene without a fault is rounding."""
    case = dataclasses.replace(BALL, floor=floor, integrator=integrator)
    evidence = Evidence(case, method)
    assert evidence.run.impacts or evidence.run.native
    # MuJoCo's contacts are soft: of them only what does not ask for energy is sure
    for verdict in judge(case, (method,), family=SHAPES).verdicts:
        if method == OURS or "energy" not in verdict.invariant:
            assert verdict.holds, verdict


def spoiled(case: Case, **changes) -> Evidence:
    evidence, copy = Evidence(case), Evidence(case)
    copy.__dict__["run"] = dataclasses.replace(
        evidence.run, **{name: change(evidence.run) for name, change in changes.items()}
    )
    copy.__dict__["again"] = evidence.run
    return copy


def changed(array, where, factor):
    copy = array.copy()
    copy[where] *= factor
    return copy


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("finite", {"qpos": lambda run: changed(run.qpos, (-1, 0), np.nan)}),
        ("impact energy", {"qvel": lambda run: changed(run.qvel, -1, 1.001)}),
        ("floor", {"qpos": lambda run: changed(run.qpos, (-1, 2), 0) - 1.0}),
        ("spin", {"qvel": lambda run: changed(run.qvel, (-1, 3), 1.001)}),
        ("same bits", {"bits": lambda _: b""}),
        (
            "no pull",
            {
                "impacts": lambda run: (
                    dataclasses.replace(run.impacts[0], impulse=-1.0),
                    *run.impacts,
                )
            },
        ),
    ],
)
def test_each_promise_sees_its_own_damage(name, changes):
    assert BY_NAME[name].value(Evidence(BALL)) <= BY_NAME[name].bound
    assert BY_NAME[name].value(spoiled(BALL, **changes)) > BY_NAME[name].bound


def exactly(model, qpos, qvel, time, substeps=100):
    """Returns where a scene is after a time without contacts, by Runge-Kutta."""
    fine = copy.copy(model)
    fine.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    fine.opt.timestep = time / substeps
    data = mujoco.MjData(fine)
    data.qpos[:], data.qvel[:] = qpos, qvel
    for _ in range(substeps):
        mujoco.mj_step(fine, data)
    mujoco.mj_forward(fine, data)
    return data


@pytest.mark.parametrize("when", [0.1, 0.5, 0.9])
def test_an_exact_impact_of_a_turning_body_adds_no_energy(when):
    """What the bound asks for can be had: the measure is not the fault of a step.

    A box with its centre beside the joint turns, and is struck within the step so that
    it keeps its energy. Its path is exact; its velocity is the one that Euler's step
    would have to leave for that path, v = V - h/2 a.
    """
    box = dataclasses.replace(BALL.trees[0], shapes=("box",))
    case = dataclasses.replace(BALL, trees=(box,), offset=0.5, steps=1, gravity=0.0)
    evidence = Evidence(case)
    model, h = evidence.scene.apart, case.timestep
    start = exactly(model, model.qpos0, evidence.scene.qvel, h)
    before = start.qvel + h / 2 * start.qacc
    struck = exactly(model, start.qpos, before, when * h)
    force = np.array([0.3, 0.2, 1.0, 0.02, -0.05, 0.01])
    answer = np.zeros((1, model.nv))
    mujoco.mj_solveM(model, struck, answer, force[None])
    impulse = -2 * (force @ struck.qvel) / (force @ answer[0])
    after = struck.qvel + impulse * answer[0]
    end = exactly(model, struck.qpos, after, (1 - when) * h)
    qvel = end.qvel.copy()
    for _ in range(10):  # a depends on v: a fixed point
        qvel = end.qvel - h / 2 * exactly(model, end.qpos, qvel, 1e-12, 1).qacc
    run = dataclasses.replace(
        evidence.run,
        qpos=np.array([start.qpos, end.qpos]),
        qvel=np.array([start.qvel, qvel]),
        begun=np.array([1]),
        quiet=np.array([True, True]),
        pushed=np.array([False]),
    )
    evidence.__dict__["run"] = run
    (stretch,) = stretches(evidence)
    # the same step without the impact is Euler's, and only as good as that
    assert stretch.growth == pytest.approx(0, abs=stretch.integration + GROWTH)
    assert np.linalg.norm(impulse * answer) > 0.1


def test_momentum_sees_a_body_that_is_faster():
    pair = dataclasses.replace(BALL.trees[0], number=1)
    case = dataclasses.replace(
        BALL, floor="none", gravity=0.0, trees=(*BALL.trees, pair)
    )
    momentum = BY_NAME["momentum"]
    assert momentum.value(Evidence(case)) <= momentum.bound
    faster = spoiled(case, qvel=lambda run: changed(run.qvel, (-1, 0), 1.001))
    assert momentum.value(faster) > momentum.bound


def test_the_height_above_a_height_field_is_that_of_a_ray():
    case = dataclasses.replace(BALL, floor="height field")
    scene = scene_of(case)
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    side, nodes = scene.floor.side, len(scene.floor.elevation)
    grid = np.linspace(-side, side, nodes)
    ground = np.array([0], dtype=np.int32)
    for x in grid[1:-1]:
        for y in grid[1:-1]:
            above = np.array([x, y, scene.floor.level + 1.0])
            # the ball is in the way of some
            distance = mujoco.mj_ray(
                scene.model, data, above, [0, 0, -1.0], None, 1, 1, ground
            )
            if ground[0] == scene.model.geom("floor").id:
                # MuJoCo keeps the elevations of the nodes in single precision
                assert scene.floor.height(above) == pytest.approx(distance, abs=1e-6)


# --- cases


def test_a_tree_stays_what_it_is_without_the_others():
    case = next(
        case for case in map(case_of, range(50)) if case.floor == "plane" and
        len(case.trees) > 2
    )  # fmt: skip
    fewer = dataclasses.replace(case, trees=case.trees[1:])
    name = f"body{case.trees[1].number}_0"
    whole, part = (scene_of(one).model for one in (case, fewer))
    assert part.nbody < whole.nbody
    assert whole.body(name).mass == part.body(name).mass
    assert (whole.body(name).inertia == part.body(name).inertia).all()


def test_the_start_is_a_keyframe_of_the_scene():
    scene = scene_of(BALL)
    assert (scene.spec.compile().key("start").qvel == scene.qvel).all()


def test_shrinking_finds_the_simplest_case_that_breaks():
    """If anything with a box breaks, one box is left, for a step."""
    family = dataclasses.replace(
        SHAPES,
        invariants=(
            Invariant(
                "no boxes",
                "there are no boxes",
                0.0,
                "a test",
                lambda evidence: float(
                    any("box" in tree.shapes for tree in evidence.case.trees)
                ),
            ),
        ),
    )
    case = next(
        case
        for case in map(case_of, range(50))
        if any("box" in tree.shapes for tree in case.trees) and len(case.trees) > 2
    )
    simplest = shrunk(case, "no boxes", family)
    assert len(simplest.trees) == 1
    assert simplest.trees[0].shapes == ("box",)
    assert simplest.trees[0].joint == "free"
    assert simplest.steps == 1
    assert simplest.floor == "plane"
    assert shrunk(BALL, "no boxes", family) == BALL
