"""No scene hangs: a step has a budget, in proportion to what it costs MuJoCo itself.

Work is counted, in units of about a nanosecond, and is in the header of the state.
"""

import mujoco
import numpy as np
import pytest

import mujoco_impact

WORK = 15  # in the header of the state: of the last step, over its budget

# What the rows of a last round take beyond their share, and the points that they touch
# in besides those that MuJoCo counts: 2.13 in the pile of rubber, the others 0.8.
OVERDRAFT = 2.3
"""What a step may take over its budget: the last round is ended, not left out."""

HALF = 0.05  # half-width of the boxes and rocks [m]
RADIUS = 0.005  # of the spheres that are one body [m]

DOCUMENT = """
<mujoco>
  <size memory="400M"/>
  <option timestep="{timestep}"/>
  <asset>{asset}</asset>
  <worldbody><geom type="plane" size="5 5 1"/>{bodies}</worldbody>
</mujoco>
"""


def pile(number: int, geom: str, *, timestep: float, asset: str = "") -> str:
    """Bodies on a lattice, turned a little, close above each other and the floor."""
    random = np.random.default_rng(1)
    width = int(np.ceil(number ** (1 / 3)))
    bodies = ""
    for i in range(number):
        place = np.array([i % width, i // width % width, i // width**2 + 1])
        x, y, z = 3 * HALF * place + 0.1 * HALF * random.normal(size=3)
        quaternion = " ".join(
            map(repr, [1.0, *(0.15 * random.normal(size=3)).tolist()])
        )
        bodies += (
            f'<body pos="{x} {y} {z}" quat="{quaternion}"><freejoint/>'
            f'<geom {geom} mass=".5"/></body>'
        )
    return DOCUMENT.format(timestep=timestep, asset=asset, bodies=bodies)


def boxes(number: int, timestep: float) -> str:
    return pile(number, f'type="box" size="{HALF} {HALF} {HALF}"', timestep=timestep)


def rocks(number: int) -> str:
    """The hull of twenty points on a sphere."""
    points = np.random.default_rng(3).normal(size=(20, 3))
    points *= 1.2 * HALF / np.linalg.norm(points, axis=1)[:, np.newaxis]
    vertices = " ".join(f"{x:.6f}" for x in points.ravel())
    asset = f'<mesh name="rock" vertex="{vertices}"/>'
    return pile(number, 'type="mesh" mesh="rock"', timestep=0.002, asset=asset)


def raft(width: int) -> str:
    """One body of a square of small spheres, tilted by half a degree."""
    middle = RADIUS * width
    geoms = "".join(
        f'<geom size="{RADIUS}" mass=".001" pos="{2 * RADIUS * (i + 0.5) - middle} '
        f'{2 * RADIUS * (j + 0.5) - middle} 0"/>'
        for i in range(width)
        for j in range(width)
    )
    body = f'<body pos="0 0 .06" euler=".5 0 0"><freejoint/>{geoms}</body>'
    return DOCUMENT.format(timestep=0.002, asset="", bodies=body)


def tied_raft(width: int) -> str:
    """The same, hung to a ball: equality constraints are part of the inertia."""
    ball = (
        '<body name="ball" pos="0 0 .2"><freejoint/><geom size=".03" mass=".2"/></body>'
    )
    tie = '<equality><connect body1="raft" body2="ball" anchor="0 0 .1"/></equality>'
    return (
        raft(width)
        .replace('<body pos="0 0 .06"', '<body name="raft" pos="0 0 .06"')
        .replace("</worldbody>", f"{ball}</worldbody>{tie}")
    )


SCENES = {
    "24 boxes, plastic": (boxes(24, 0.01), {"restitution": 0.0}, 60),
    "64 boxes": (boxes(64, 0.002), {"restitution": 0.5}, 140),
    "64 boxes, viscous": (
        boxes(64, 0.002),
        {"restitution": 0.5, "dissipation": "viscous"},
        140,
    ),
    "64 boxes, elastic": (boxes(64, 0.002), {"restitution": 1.0}, 140),
    "64 boxes of rubber": (boxes(64, 0.002), {"restitution": 0.5, "young": 1e6}, 140),
    "126 rocks": (rocks(126), {"restitution": 0.5}, 140),
    "576 spheres of one body": (raft(24), {"restitution": 0.5}, 140),
    "the same, plastic": (raft(24), {"restitution": 0.0}, 70),
}


def work_of_step(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Of the last step, over its budget."""
    return float(data.plugin_state[model.plugin_stateadr[0] + WORK])


class Energy:
    """Kinetic and potential energy of the bodies of a scene [J].

    At the velocity of their path, half a step ahead of that of Euler's steps: else
    every bounce shows a false m g h u.
    """

    def __init__(self, xml: str):
        self._model = mujoco.MjModel.from_xml_string(xml)
        self._model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        self._model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
        self._data = mujoco.MjData(self._model)

    def __call__(self, data: mujoco.MjData) -> float:
        self._data.qpos, self._data.qvel = data.qpos, data.qvel
        mujoco.mj_forward(self._model, self._data)
        self._data.qvel += 0.5 * self._model.opt.timestep * self._data.qacc_smooth
        mujoco.mj_energyVel(self._model, self._data)
        return float(self._data.energy.sum())


@pytest.mark.parametrize("depth", [None, 1e-6], ids=["default depth", "depth 1 um"])
@pytest.mark.parametrize("scene", SCENES)
def test_a_crowded_step_keeps_to_its_budget(scene, depth):
    """And what is ended for want of work adds no energy, nor lets bodies through."""
    xml, settings, steps = SCENES[scene]
    model = mujoco_impact.attach(
        xml, depth=depth, **settings, friction="none"
    ).compile()
    data = mujoco.MjData(model)
    energy = Energy(xml)
    energies = [energy(data)]
    half = HALF if model.nbody > 2 else RADIUS
    worst = 0.0
    for _ in range(steps):
        mujoco.mj_step(model, data)
        energies.append(energy(data))
        worst = max(worst, work_of_step(model, data))
        assert work_of_step(model, data) < OVERDRAFT
        # no centre comes near to the floor: default depths are up to half of a radius
        assert data.geom_xpos[1:, 2].min() > 0.4 * half
    # there was something to do
    assert worst > 0.1
    # MuJoCo's own contacts, where a body rests on one, give back a little of its depth,
    # and a box that they hold is met to first order in its turn: .1 rad in 10 ms
    part = 2e-2 if model.opt.timestep > 5e-3 else 5e-3
    assert np.diff(energies).max() < part * energies[0]
    assert max(energies) < (1 + 5e-3) * energies[0]


def test_tied_bodies_keep_to_it_as_well():
    """What ties join counts as one body."""
    model = mujoco_impact.attach(
        tied_raft(24), restitution=0.5, friction="none"
    ).compile()
    data = mujoco.MjData(model)
    worst = 0.0
    for _ in range(100):
        mujoco.mj_step(model, data)
        worst = max(worst, work_of_step(model, data))
        assert data.geom_xpos[1:, 2].min() > 0.4 * RADIUS
    assert 0.1 < worst < OVERDRAFT


def test_a_step_without_impacts_has_no_work():
    model = mujoco_impact.attach(raft(2), friction="none").compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    assert work_of_step(model, data) == 0


def test_the_work_of_a_step_does_not_depend_on_how_often_it_is_computed():
    model = mujoco_impact.attach(raft(8), restitution=0.5, friction="none").compile()
    data = mujoco.MjData(model)
    while work_of_step(model, data) == 0:
        mujoco.mj_step(model, data)
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    mujoco.mj_step(model, data)
    once = work_of_step(model, data)
    mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    for _ in range(3):
        mujoco.mj_forward(model, data)
    mujoco.mj_step(model, data)
    assert work_of_step(model, data) == once


def test_a_long_elastic_row_is_solved_to_its_end():
    """Its wave takes 13 steps of the law a contact; every ball but the last rests."""
    number = 120
    bodies = "".join(
        f'<body pos="{0.03 * i - 5e-4 * (i == 0)!r} 0 1">'
        '<joint type="slide" axis="1 0 0"/><geom size=".015" mass=".1"/></body>'
        for i in range(number)
    )
    xml = DOCUMENT.format(timestep=0.01, asset="", bodies=bodies)
    model = mujoco_impact.attach(xml, friction="none").compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 0.5
    for _ in range(3):
        mujoco.mj_step(model, data)
    # of Hertz contacts: the last of a long row takes nearly all
    assert 0.98 < data.qvel[-1] / 0.5 < 1
    assert np.abs(data.qvel[: number // 2]).max() < 0.1 * 0.5
    np.testing.assert_allclose(data.qvel @ data.qvel, 0.25, rtol=1e-12)
