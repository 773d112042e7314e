"""A short sweep: the promises hold, and the sweep can tell when they do not."""

import dataclasses
import logging
import os
import signal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mujoco_impact_lab.stress import (
    DEFAULTS,
    INVARIANTS,
    OURS,
    Case,
    Evidence,
    case_of,
    digest,
    judge,
    limit_of,
    summarise,
    sweep,
)
from mujoco_impact_lab.stress.case import INTEGRATORS, LAYOUTS

BY_NAME = {invariant.name: invariant for invariant in INVARIANTS}

# the same scenes in every run: a failure is a change of the code
examples = settings(max_examples=60, deadline=None, derandomize=True)


def broken(outcome) -> list[str]:
    return [
        f"{verdict.invariant} = {verdict.value:.3g} in {outcome.case.describe()}"
        for verdict in outcome.verdicts
        if verdict.is_violation
    ]


def test_random_scenes_keep_every_promise():
    outcomes = sweep(range(10_000, 10_150), methods=(OURS,))
    assert not [text for outcome in outcomes for text in broken(outcome)]
    assert not [outcome.failure for outcome in outcomes if outcome.failure]
    # the scenes are worth judging
    assert sum(outcome.impacts > 0 for outcome in outcomes) > 100


@pytest.mark.parametrize(
    "seed",
    [
        # pulses of two steps that end before the next ball is reached: the whole row
        # was one impact, and what had yet to begin came when the first pulse was over
        9093,
        # the same with masses 1 : 3.6e5, where the order of the bodies showed
        7574,
    ],
)
def test_a_scene_that_broke_a_promise_keeps_all(seed):
    (outcome,) = sweep([seed], methods=(OURS,))
    # not by an excuse, either
    assert all(verdict.holds for verdict in outcome.verdicts)


@st.composite
def cases(draw) -> Case:
    """Small scenes, so that hypothesis shrinks to something readable."""
    layout = draw(st.sampled_from(LAYOUTS))
    joints = ("free", "slides", "rail") if layout == "row" else ("free", "slides")
    speed = draw(st.sampled_from((0.1, 1.0, 5.0)))
    return dataclasses.replace(
        case_of(0),
        seed=draw(st.integers(0, 2**16)),
        layout=layout,
        joint=draw(st.sampled_from(joints)),
        count=draw(st.integers(3, 6)),
        radius=draw(st.sampled_from((0.01, 0.03))),
        radius_ratio=draw(st.sampled_from((1.0, 2.0))),
        density=7800.0,
        mass_ratio=draw(st.sampled_from((1.0, 3.0, 10.0, 100.0))),
        young=draw(st.sampled_from((2e11, 1e7))),
        restitution=draw(st.sampled_from((1.0, 0.9, 0.5, 0.05))),
        dissipation=draw(st.sampled_from(("bistiffness", "viscous"))),
        duration=draw(st.sampled_from((None, 2e-4, 3e-2))),
        timestep=draw(st.sampled_from((2e-4, 5e-3, 2e-2))),
        integrator=draw(st.sampled_from(INTEGRATORS)),
        speed=speed,
        gap=draw(st.sampled_from((0.0, 1e-6, 1e-3))),
        overlap=0.0,
        features=(),
        steps=60,
    )


@examples
@given(cases())
def test_any_scene_keeps_every_promise(case):
    outcome = judge(case, (OURS,))
    assert not outcome.failure
    assert not broken(outcome)


# --- the sweep itself


def test_a_case_is_its_seed():
    assert case_of(7) == case_of(7)
    assert case_of(7) != case_of(8)
    assert "seed 7:" in case_of(7).describe()


def test_the_outcome_does_not_depend_on_who_does_the_work():
    alone, together = (
        sweep(range(20, 30), methods=(OURS,), processes=n) for n in (1, 2)
    )
    assert digest(alone) == digest(together)


def test_a_cluster_that_loses_a_worker_loses_nothing():
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
    )
    with cluster, distributed.Client(cluster) as client:
        pids = list(client.run(os.getpid).values())

        def kill(outcome):
            if outcome.case.seed == 30:
                os.kill(pids[0], signal.SIGKILL)

        shared = sweep(
            range(20, 60),
            methods=(OURS,),
            executor=client.get_executor(),
            progress=kill,
        )
    assert digest(shared) == digest(sweep(range(20, 60), methods=(OURS,), processes=1))


def test_mujocos_defaults_break_promises_that_ours_keep():
    """Stiff or fast scenes gain energy: the sweep is not blind."""
    summary = summarise(sweep(range(40), methods=(OURS, DEFAULTS)))
    assert summary.violations(OURS) == 0
    assert summary.tally(DEFAULTS, "energy growth").violations > 0
    assert summary.tally(DEFAULTS, "energy growth").seeds


@pytest.fixture(scope="module")
def elastic() -> Evidence:
    """A free elastic scene with an impact."""
    for seed in range(2000):
        case = case_of(seed)
        evidence = Evidence(case)
        if not (case.is_free and case.is_elastic and case.count > 2):
            continue
        if evidence.run.impacts and not limit_of(evidence, "elastic energy"):
            return evidence
    raise AssertionError("no such scene")


def spoiled(evidence: Evidence, **changes) -> Evidence:
    copy = Evidence(evidence.case)
    copy.__dict__["_pair"] = (
        dataclasses.replace(evidence.run, **changes),
        evidence.again,
    )
    return copy


def test_each_invariant_sees_its_own_damage(elastic):
    run = elastic.run
    faster = run.velocity.copy()
    faster[-1] *= 1.01
    nan = run.qpos.copy()
    nan[-1, 0] = np.nan
    through = run.position.copy()
    # the first two balls change places
    through[-1, [0, 1]] = through[-2, [1, 0]]
    pull = (dataclasses.replace(run.impacts[0], impulse=-1.0), *run.impacts)
    quiet = np.ones_like(run.quiet)
    kinetic = 0.5 * run.balls.mass @ np.sum(run.velocity[0] ** 2, axis=1)
    for name, changes in (
        ("finite", {"qpos": nan}),
        ("momentum", {"velocity": faster}),
        ("energy growth", {"velocity": faster, "quiet": quiet}),
        ("elastic energy", {"energy": kinetic * np.linspace(1, 2, len(quiet))}),
        ("no pull", {"impacts": pull}),
        ("no passing", {"position": through}),
        ("same bits", {"bits": b""}),
    ):
        if name == "elastic energy":
            changes["quiet"] = quiet
        value = BY_NAME[name].value(spoiled(elastic, **changes))
        assert value > BY_NAME[name].bound, name


def test_symmetries_see_an_image_that_does_something_else(elastic):
    image = Evidence(elastic.case)
    image.__dict__["fine"] = (image, image)
    for name in ("permuted", "mirrored"):
        record = getattr(elastic, name)
        changed = dataclasses.replace(record, velocity=1.01 * record.velocity)
        image.__dict__[name] = changed
    assert BY_NAME["permutation"].value(image) > 1e-3
    assert BY_NAME["mirror"].value(image) > 1e-3


def test_limits_are_measured_on_the_case(elastic):
    """A scene within all limits has none to excuse it."""
    assert limit_of(elastic, "finite") == ""
    assert limit_of(elastic, "no passing") == ""
