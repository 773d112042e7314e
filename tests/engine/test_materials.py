"""Materials of geoms: what a contact of two of them does."""

import itertools
from dataclasses import replace

import mujoco
import numpy as np
import pytest

import mujoco_impact
from mujoco_impact import MATERIALS, Material, MaterialPair, attach
from mujoco_impact.errors import ConfigError

RADIUS, HEIGHT, MASS, GRAVITY = 0.03, 0.3, 0.1, 9.81

SOFT = Material(restitution=0.5, young=1e9, poisson=0.4)
HARD = Material(restitution=0.9, young=3e9, poisson=0.2)
OWN = {"soft": SOFT, "hard": HARD}


def compliance(one: Material) -> float:
    assert one.young is not None
    assert one.poisson is not None
    return (1 - one.poisson**2) / one.young


def composite(one: Material, other: Material) -> float:
    """Each takes the part of the work that its compliance is of both."""
    a, b = compliance(one), compliance(other)
    assert one.restitution is not None
    assert other.restitution is not None
    return float(np.sqrt((a * one.restitution**2 + b * other.restitution**2) / (a + b)))


def table_of(names, *, head=""):
    """Balls that fall side by side on one table, which all of them can touch."""
    balls = "".join(
        f'<body pos="{0.2 * i} 0 {RADIUS + HEIGHT}"><freejoint/>'
        f'<geom name="ball_{name}" size="{RADIUS}" mass="{MASS}"/></body>'
        for i, name in enumerate(names)
    )
    return f"""
    <mujoco><option timestep=".002" gravity="0 0 {-GRAVITY}" {head}/><worldbody>
      <geom name="table" type="plane" size="1 1 .1"/>{balls}
    </worldbody></mujoco>"""


def rebounds(model: mujoco.MjModel) -> dict[str, float]:
    """Height of the first apex over that of the fall, by ball."""
    data = mujoco.MjData(model)
    balls = [model.geom(i).name for i in range(model.ngeom) if model.geom_bodyid[i]]
    heights = []
    while data.time < 0.75:
        mujoco.mj_step(model, data)
        heights.append([data.geom(ball).xpos[2] - RADIUS for ball in balls])
    impact = int(np.sqrt(2 * HEIGHT / GRAVITY) / model.opt.timestep) + 2
    return {
        ball: float(path[impact:].max()) / HEIGHT
        for ball, path in zip(balls, np.array(heights).T, strict=True)
    }


# 2e-3 is what is promised. The largest sample is within g (h/2)²/2 of the apex: 5e-6 m,
# 2e-5 of the height.
REBOUND = 2e-3

THREE = ("steel", "phenolic", "rubber")


@pytest.mark.parametrize("table", ["steel", "cloth"])
def test_three_materials_on_one_table_rebound_each_by_its_own(table):
    assign = {f"ball_{name}": name for name in THREE} | {"table": table}
    model = attach(table_of(THREE), assign=assign).compile()
    for name in THREE:
        e = composite(MATERIALS[name], MATERIALS[table])
        assert rebounds(model)[f"ball_{name}"] == pytest.approx(e**2, abs=REBOUND)


def test_no_order_of_naming_changes_a_bit():
    ends = []
    for order in itertools.permutations(THREE):
        own = {name: MATERIALS[name] for name in order}
        assign = {f"ball_{name}": name for name in order}
        assign = (
            {"table": "glass"} | assign
            if order[0] == "steel"
            else assign | {"table": "glass"}
        )
        model = attach(table_of(THREE), materials=own, assign=assign).compile()
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, 300)
        ends.append(data.qpos.copy())
    for end in ends[1:]:
        np.testing.assert_array_equal(end, ends[0])


@pytest.mark.parametrize("order", list(itertools.permutations(THREE)))
def test_three_instances_on_one_table_in_any_order_of_attaching(order):
    """Their balls can meet, so the materials of one must be known to the others."""
    spec = table_of(THREE)
    for name in order:
        spec = attach(
            spec,
            geoms=[f"ball_{name}"],
            name=f"of_{name}",
            assign={f"ball_{name}": name, "table": "cloth"},
        )
    found = rebounds(spec.compile())
    for name in THREE:
        e = composite(MATERIALS[name], MATERIALS["cloth"])
        assert found[f"ball_{name}"] == pytest.approx(e**2, abs=REBOUND)


@pytest.mark.parametrize("told", [{"ball_rubber": "rubber"}, {}])
@pytest.mark.parametrize("last", ["one", "other"])
def test_instances_say_the_same_of_a_geom_that_one_of_them_owns(told, last):
    """Its contacts would have the material that the instance attached first says."""
    instances = {
        "one": {"geoms": ["ball_steel"], "assign": {"ball_rubber": "steel"}},
        "other": {"geoms": ["ball_rubber"], "assign": told},
    }
    final = instances.pop(last)
    ((name, first),) = instances.items()
    spec = attach(table_of(("steel", "rubber")), name=name, **first)
    owned = "of 'rubber'" if told else "of no material"
    reason = (
        "'ball_rubber' is of 'steel' in the tuple 'one' and "
        f"{owned} in the instance 'other', which owns it"
    )
    with pytest.raises(ConfigError, match=reason):
        attach(spec, name=last, **final)


def test_materials_of_one_name_are_the_same_in_all_instances_that_say_them():
    spec = attach(
        table_of(("steel", "rubber")),
        geoms=["ball_steel"],
        name="one",
        materials={"own": SOFT},
        assign={"ball_rubber": "own"},
    )
    again = {
        "geoms": ["ball_rubber"],
        "name": "other",
        "assign": {"ball_rubber": "own"},
    }
    assert (
        attach(spec, materials={"own": replace(SOFT)}, **again).compile().nplugin == 2
    )
    with pytest.raises(
        ConfigError, match="is of 'own' in the tuple 'one' and of 'own'"
    ):
        attach(spec, materials={"own": HARD}, **again)


HEAD_ON = """
<mujoco><option timestep=".001" gravity="0 0 0"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".02" mass=".1"/></default>
  <worldbody>
    <body><joint/><geom name="left"/></body>
    <body pos=".0403 0 0"><joint/><geom name="right"/></body>
  </worldbody>
</mujoco>"""


def strike(spec: mujoco.MjSpec, speed: float = 1.0) -> mujoco_impact.Impact:
    """The impact of two equal balls."""
    motion = mujoco_impact.run(spec, duration=0.02, qvel=[speed, 0.0])
    (impact,) = motion.impacts
    return impact


def restitution_of(spec: mujoco.MjSpec, speed: float = 1.0) -> float:
    """(1 + e) m u / 2 is the impulse of two equal balls."""
    impact = strike(spec, speed)
    return impact.impulse / (0.05 * speed) - 1


@pytest.mark.parametrize("sides", [("soft", "hard"), ("hard", "soft")])
def test_a_contact_of_two_materials_is_a_hertz_contact_in_series(sides):
    """Largest force of a Hertz contact: K y^1.5, y = (5 mu u²/(4 K))^0.4."""
    elastic = {
        name: {"restitution": 1, "young": one.young, "poisson": one.poisson}
        for name, one in OWN.items()
    }
    spec = attach(
        HEAD_ON,
        materials=elastic,
        assign=dict(zip(("left", "right"), sides, strict=True)),
    )
    impact = strike(spec)
    modulus = 1 / (compliance(SOFT) + compliance(HARD))
    K = 4 / 3 * modulus * np.sqrt(0.01)
    y = (1.25 * 0.05 / K) ** 0.4
    # the largest force is a closed form; the duration is known to 5e-6: with it the
    # waveform has the centre of the Hertz force
    assert impact.peak == pytest.approx(K * y**1.5, rel=1e-9)
    assert impact.duration == pytest.approx(2.9432751843247 * y, rel=1e-5)


@pytest.mark.parametrize("sides", [("soft", "hard"), ("hard", "soft")])
def test_restitution_of_two_materials_is_work_equivalent(sides):
    assign = dict(zip(("left", "right"), sides, strict=True))
    spec = attach(HEAD_ON, materials=OWN, assign=assign)
    # a closed form
    assert restitution_of(spec) == pytest.approx(composite(SOFT, HARD), rel=1e-9)


def test_a_geom_without_material_is_as_the_settings_say():
    settings = {"restitution": 0.8, "young": 2e9, "poisson": 0.1}
    spec = attach(HEAD_ON, materials=OWN, assign={"left": "soft"}, **settings)
    assert restitution_of(spec) == pytest.approx(
        composite(SOFT, Material(**settings)), rel=1e-9
    )


def test_a_material_that_says_nothing_is_as_the_settings():
    plain = strike(attach(HEAD_ON, restitution=0.8, young=1e9))
    of_nothing = attach(
        HEAD_ON,
        materials={"nothing": {}},
        assign={"*": "nothing"},
        restitution=0.8,
        young=1e9,
    )
    assert strike(of_nothing).impulse == plain.impulse
    # 1/(C + C) instead of E/(2 (1 - nu^2)): rounding
    assert strike(of_nothing).peak == pytest.approx(plain.peak, rel=1e-14)


@pytest.mark.parametrize("speed", [0.05, 0.5, 4.0])
def test_restitution_falls_with_the_fifth_root_of_the_speed(speed):
    spec = attach(
        HEAD_ON, materials={"of": {"restitution_loss": 0.2}}, assign={"*": "of"}
    )
    assert restitution_of(spec, speed) == pytest.approx(1 - 0.2 * speed**0.2, rel=1e-9)


@pytest.mark.parametrize(
    ("speed", "e"), [(0.05, 0.95), (0.1, 0.95), (0.6, 0.85), (1.1, 0.75), (4.0, 0.75)]
)
def test_a_table_of_restitutions_is_linear_between_and_constant_beyond(speed, e):
    table = {1.1: 0.75, 0.1: 0.95}
    spec = attach(
        HEAD_ON, materials={"of": {"restitution_table": table}}, assign={"*": "of"}
    )
    assert restitution_of(spec, speed) == pytest.approx(e, rel=1e-9)


def test_what_comes_faster_but_later_leaves_a_restitution_as_it_is():
    """Two contacts of one step, half a millisecond apart: each has its own speed."""
    spec = attach(
        ROW, speed=3, materials={"of": {"restitution_loss": 0.3}}, assign={"*": "of"}
    )
    model = spec.compile()
    qpos = [0.0002 - 0.00001, 0.0, 0.001]
    motion = mujoco_impact.run(model, duration=0.002, qpos=qpos, qvel=[0.1, 0, -2.0])
    slow, fast = motion.impacts
    assert (slow.geoms, fast.geoms) == (("a", "b"), ("b", "c"))
    # the second strikes what the first has sent towards it
    for impact in (slow, fast):
        e = 1 - 0.3 * impact.closing_speed**0.2
        assert impact.restitution == pytest.approx(e, rel=1e-9)
    assert slow.closing_speed == pytest.approx(0.1, rel=1e-6)


def test_a_loss_that_is_too_large_ends_at_nothing():
    spec = attach(
        HEAD_ON, materials={"of": Material(restitution_loss=3.0)}, assign={"*": "of"}
    )
    assert restitution_of(spec) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("names", [("soft", "hard"), ("hard", "soft")])
def test_a_pair_of_materials_says_what_counts_between_them(names):
    spec = attach(
        HEAD_ON,
        materials=OWN,
        assign={"left": "soft", "right": "hard"},
        pairs={names: MaterialPair(restitution=0.3, modulus=5e9)},
    )
    K = 4 / 3 * 5e9 * np.sqrt(0.01)
    assert restitution_of(spec) == pytest.approx(0.3, rel=1e-9)
    # the duration of a waveform that loses energy is another than the Hertz contact's:
    # its peak, when compression ends, is not
    y = (1.25 * 0.05 / K) ** 0.4
    assert strike(spec).peak == pytest.approx(K * y**1.5, rel=1e-9)


@pytest.mark.parametrize(
    ("pairs", "e"),
    [
        ({("left", "right"): 0.2, ("left", "hard"): 0.3, ("soft", "hard"): 0.4}, 0.2),
        ({("hard", "left"): 0.3, ("soft", "hard"): 0.4}, 0.3),
        ({("soft", "hard"): 0.4, ("soft", "soft"): 0.1}, 0.4),
        ({("right", "left"): 0.2}, 0.2),
    ],
)
def test_a_pair_of_geoms_counts_more_than_that_of_their_materials(pairs, e):
    spec = attach(
        HEAD_ON,
        materials=OWN,
        assign={"left": "soft", "right": "hard"},
        pairs={names: {"restitution": one} for names, one in pairs.items()},
    )
    assert restitution_of(spec) == pytest.approx(e, rel=1e-9)


def test_a_pair_of_geoms_needs_no_materials():
    spec = attach(
        HEAD_ON, restitution=0.9, pairs={("left", "right"): {"restitution": 0.6}}
    )
    assert restitution_of(spec) == pytest.approx(0.6, rel=1e-9)


def test_a_pair_that_says_friction_alone_leaves_the_rest():
    spec = attach(
        HEAD_ON,
        materials=OWN,
        assign={"left": "soft", "right": "hard"},
        pairs={("left", "right"): {"friction": 0.0}},
    )
    assert restitution_of(spec) == pytest.approx(composite(SOFT, HARD), rel=1e-9)


SLIDING = """
<mujoco><option timestep=".002" gravity="0 0 0"/><worldbody>
  <geom name="table" type="plane" size="2 2 .1" friction=".3" {table}/>
  <body pos="0 0 .035"><freejoint/>
    <geom name="ball" size=".03" mass=".1" friction=".2" {ball}/></body>
</worldbody>{tail}</mujoco>"""

LISTED = '<contact><pair geom1="ball" geom2="table" friction=".07"/></contact>'


def friction_of(
    ball: float | None,
    table: float | None,
    *,
    pair: float | None = None,
    tail: str = "",
    **attributes: str,
) -> float:
    """Tangential over normal impulse of a ball that slides throughout."""
    scene = SLIDING.format(
        ball=attributes.get("ball_is", ""),
        table=attributes.get("table_is", ""),
        tail=tail,
    )
    spec = attach(
        scene,
        materials={"one": Material(friction=ball), "other": Material(friction=table)},
        assign={"ball": "one", "table": "other"},
        pairs={} if pair is None else {("one", "other"): {"friction": pair}},
    )
    motion = mujoco_impact.run(spec, duration=0.02, qvel=[9.0, 0, -1.0, 0, 0, 0])
    (impact,) = motion.impacts
    return float(np.linalg.norm(impact.tangential_impulse)) / impact.impulse


@pytest.mark.parametrize(
    ("options", "mu"),
    [
        ({"ball": None, "table": None}, 0.3),  # MuJoCo's own: the larger of the geoms
        ({"ball": 0.1, "table": 0.15}, 0.15),
        ({"ball": 0.1, "table": None}, 0.3),
        ({"ball": 0.4, "table": None}, 0.4),
        ({"ball": 0.1, "table": 0.15, "ball_is": 'priority="1"'}, 0.1),
        ({"ball": 0.4, "table": None, "table_is": 'priority="1"'}, 0.3),
        ({"ball": 0.1, "table": 0.15, "pair": 0.05}, 0.05),
        ({"ball": 0.1, "table": 0.15, "tail": LISTED}, 0.07),
        ({"ball": 0.1, "table": 0.15, "pair": 0.05, "tail": LISTED}, 0.05),
    ],
)
def test_friction_of_a_material_counts_as_that_of_its_geom(options, mu):
    # the rotation of a ball that is not exactly at the table yet: 1e-9
    assert friction_of(**options) == pytest.approx(mu, rel=1e-8)


def test_a_contact_without_friction_gets_none_from_a_material():
    assert friction_of(0.1, 0.1, ball_is='condim="1"', table_is='condim="1"') == 0


ROW = """
<mujoco><option timestep=".002" gravity="0 0 0"/>
  <default><joint type="slide" axis="1 0 0"/><geom size=".02" mass=".1"/></default>
  <worldbody>
    <body pos="-.0002 0 0"><joint/><geom name="a"/></body>
    <body pos=".04 0 0"><joint/><geom name="b"/></body>
    <body pos=".08 0 0"><joint/><geom name="c"/></body>
  </worldbody>
</mujoco>"""


def test_a_row_of_different_materials_is_the_impact_of_its_contacts():
    """Each contact with its own stiffness and restitution, held against the law."""
    spec = attach(
        ROW, materials=OWN, assign={"a": "soft", "b": "hard", "c": "hard"}, speed=1
    )
    motion = mujoco_impact.run(spec, duration=0.02, qvel=[1.0, 0, 0])
    moduli = [
        1 / (compliance(SOFT) + compliance(HARD)),
        1 / (2 * compliance(HARD)),
    ]
    solution = mujoco_impact.law.solve_impact(
        np.array([[20.0, -10.0], [-10.0, 20.0]]),
        [1.0, 0.0],
        4 / 3 * np.array(moduli) * np.sqrt(0.01),
        restitution=[composite(SOFT, HARD), 0.9],
        tolerance=1e-8,
    )
    P = solution.impulse
    expected = [1 - 10 * P[0], 10 * (P[0] - P[1]), 10 * P[1]]
    # 1e-5 of the speed: the accuracy of an impact at the default tolerance
    np.testing.assert_allclose(motion.qvel[-1], expected, atol=1e-5)


def test_pulses_of_one_duration_have_one_shape():
    """Else what comes earlier at one contact would move bodies into each other.

    With one shape all balls move as if the impact came at one time: they have been
    moved for the same time by what it changed.
    """
    spec = attach(
        ROW,
        speed=1,
        duration=1e-3,
        assign={"a": "steel", "b": "steel", "c": "steel"},
        pairs={("a", "b"): {"restitution": 0.9}, ("b", "c"): {"restitution": 0.1}},
    )
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    for _ in range(3):
        mujoco.mj_step(model, data)
    moved = data.qpos - [data.time, 0, 0]
    times = moved / (data.qvel - [1.0, 0, 0])
    # 2e-12 m is the rounding of positions, over speeds of .1 m/s
    np.testing.assert_allclose(times, times[0], atol=1e-9)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4", "discrete"])
def test_materials_hold_under_every_integrator(integrator):
    names = ("steel", "phenolic")
    spec = attach(
        table_of(names, head=f'integrator="{integrator}"'),
        assign={f"ball_{name}": name for name in names} | {"table": "steel"},
    )
    found = rebounds(spec.compile())
    for name in names:
        e = composite(MATERIALS[name], MATERIALS["steel"])
        assert found[f"ball_{name}"] == pytest.approx(e**2, abs=REBOUND)


def test_viscous_losses_are_of_each_material():
    spec = attach(
        table_of(THREE),
        dissipation="viscous",
        assign={f"ball_{name}": name for name in THREE} | {"table": "steel"},
    )
    found = rebounds(spec.compile())
    for name in THREE:
        e = composite(MATERIALS[name], MATERIALS["steel"])
        assert found[f"ball_{name}"] == pytest.approx(e**2, abs=REBOUND)


def test_energy_never_grows_and_momentum_stays_among_many_materials():
    """Balls of all materials rush together, with friction and without gravity.

    All are stiff, so that impacts are over within a step: in a longer one bodies give
    back what they stored.
    """
    names = sorted(MATERIALS)
    stiff = {name: replace(MATERIALS[name], young=1e9) for name in names}
    turn = np.random.default_rng(3).normal(size=(len(names), 3))
    away = turn / np.linalg.norm(turn, axis=1)[:, None]
    balls = "".join(
        f'<body pos="{x} {y} {z}"><freejoint/>'
        f'<geom name="{name}" size=".03" mass=".1"/></body>'
        for name, (x, y, z) in zip(names, 0.2 * away, strict=True)
    )
    xml = f"""
    <mujoco><option timestep=".002" gravity="0 0 0"><flag energy="enable"/></option>
      <worldbody>{balls}</worldbody></mujoco>"""
    assign = {name: name for name in names}
    model = attach(xml, speed=6, materials=stiff, assign=assign).compile()
    data = mujoco.MjData(model)
    data.qvel.reshape(-1, 6)[:, :3] = -2 * away
    before = data.qvel.reshape(-1, 6)[:, :3].sum(axis=0)
    energies = []
    for _ in range(300):
        mujoco.mj_step(model, data)
        energies.append(data.energy[1])
    assert data.sensor("impact").data[6::11].sum() >= 10
    # what the stress report promises: 1e-9 of the energy, 1e-10 of the momentum
    assert np.max(np.diff(energies)) < 1e-9 * energies[0]
    after = data.qvel.reshape(-1, 6)[:, :3].sum(axis=0)
    np.testing.assert_allclose(after, before, atol=1e-10)
