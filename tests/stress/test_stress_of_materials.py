"""Random scenes of materials: a short sweep, and that it can tell what breaks."""

import dataclasses

import pytest
from judged import violations

from mujoco_impact import Material, MaterialPair
from mujoco_impact_lab.stress import MATERIALS, OURS, sweep
from mujoco_impact_lab.stress.shapes import Case, Evidence, Tree, case_with_materials
from mujoco_impact_lab.stress.shapes.materials import Materials, materials_of

BY_NAME = {invariant.name: invariant for invariant in MATERIALS.invariants}

SEEDS = range(2065, 2120)

BALLS = Case(
    seed=1,
    trees=(
        Tree(number=0, joint="free", shapes=("sphere",), links=1),
        Tree(number=1, joint="free", shapes=("sphere",), links=1),
    ),
    floor="none",
    size=0.1,
    offset=0.0,
    density=1000.0,
    mass_ratio=1.0,
    gravity=0.0,
    restitution=0.8,
    condim=3,
    cone="pyramidal",
    jacobian="dense",
    integrator="Euler",
    timestep=2e-3,
    pace=0.3,
    spin=1.0,
    clearance=0.02,
    steps=20,
    materials=2,
)
"""Two balls that turn and meet."""

ONE, OTHER = "geom0_0_0", "geom1_0_0"


@pytest.fixture(scope="module")
def outcomes():
    return sweep(SEEDS, family=MATERIALS, methods=(OURS,))


@pytest.mark.parametrize("name", BY_NAME)
def test_random_materials_keep_their_promises(outcomes, name):
    assert not violations(outcomes, name)


def test_the_sample_is_worth_judging(outcomes):
    assert not [outcome.failure for outcome in outcomes if outcome.failure]
    assert sum(outcome.impacts > 0 for outcome in outcomes) > 20
    judged = {v.invariant for outcome in outcomes for v in outcome.verdicts}
    assert judged == set(BY_NAME)
    said: list[Material | MaterialPair] = []
    for seed in SEEDS:
        evidence = Evidence(case_with_materials(seed))
        for impact in evidence.run.impacts:
            materials = evidence.scene.materials
            pair = materials.pair_of(*impact.geoms)
            said += [pair, *materials.each_of(*impact.geoms)]
    struck = {
        (type(one), field.name)
        for one in said
        for field in dataclasses.fields(one)
        if getattr(one, field.name) is not None
    }
    assert struck == {
        (kind, field.name)
        for kind in (Material, MaterialPair)
        for field in dataclasses.fields(kind)
    }
    assert Material() in said


def told(materials: Materials) -> Evidence:
    """Returns a run of the balls whose scene is said to be of these materials."""
    evidence = Evidence(BALLS)
    assert evidence.run.impacts
    evidence.__dict__["scene"] = dataclasses.replace(
        evidence.scene, materials=materials
    )
    return evidence


SAID = {"restitution": 0.5, "friction": 0.0}


@pytest.mark.parametrize("name", ["materials", "friction"])
@pytest.mark.parametrize(
    "materials",
    [
        Materials({"a": Material(**SAID)}, {ONE: "a", OTHER: "a"}, {}),
        Materials({}, {}, {(OTHER, ONE): MaterialPair(**SAID)}),
        Materials(
            {"a": Material(), "b": Material()},
            {ONE: "a", OTHER: "b"},
            {("b", "a"): MaterialPair(**SAID)},
        ),
    ],
    ids=["of each", "of a pair of geoms", "of a pair of materials"],
)
def test_a_contact_that_is_not_as_its_materials_say_is_seen(name, materials):
    promise = BY_NAME[name]
    assert promise.value(Evidence(BALLS)) <= promise.bound
    assert promise.value(told(materials)) > promise.bound


def test_restitution_sees_an_impact_that_takes_something_else():
    promise = BY_NAME["restitution"]
    case = dataclasses.replace(BALLS, condim=1)
    evidence, other = Evidence(case), Evidence(case)
    assert promise.value(evidence) <= promise.bound
    impact = evidence.run.impacts[0]
    wrong = dataclasses.replace(impact, restitution=impact.restitution + 1e-3)
    other.__dict__["run"] = dataclasses.replace(evidence.run, impacts=(wrong,))
    assert promise.value(other) > promise.bound


def test_names_sees_other_bits():
    evidence = Evidence(BALLS)
    evidence.__dict__["renamed"] = dataclasses.replace(evidence.run, bits=b"")
    assert BY_NAME["names"].value(evidence) > 0


def test_a_geom_keeps_its_material_without_the_others():
    case = dataclasses.replace(BALLS, materials=4)
    geoms = [f"geom{tree}_0_0" for tree in range(9)]
    every, few = materials_of(case, geoms), materials_of(case, geoms[3:])
    assert few.assign == {g: m for g, m in every.assign.items() if g in geoms[3:]}
    assert few.materials == every.materials
