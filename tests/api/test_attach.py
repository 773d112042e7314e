"""`attach` and `detach` on scenes that were not written for them."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mujoco_impact import attach
from mujoco_impact.errors import ConfigError, ImpactError, SceneError
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.scene import detach

FREE_BALL = """
<mujoco>{head}
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1" {floor}/>
    <body pos="0 0 {height}"><freejoint/><geom name="ball" size=".02" {ball}/></body>
  </worldbody>{tail}
</mujoco>
"""


def free_ball(
    *,
    head: str = "",
    floor: str = "",
    height: float = 1.0,
    ball: str = "",
    tail: str = "",
) -> str:
    """Returns a ball above a floor, with additions."""
    return FREE_BALL.format(head=head, floor=floor, height=height, ball=ball, tail=tail)


def margins(model: mujoco.MjModel, name: str) -> tuple[float, float]:
    """Returns margin and gap of a geom [m]."""
    geom = model.geom(name)
    return float(geom.margin[0]), float(geom.gap[0])


def test_owns_every_colliding_geom_of_every_body_that_can_move(mixed: str) -> None:
    """Also of bodies welded to moving ones; not decoration, not fixed geoms."""
    owned = owned_geoms(attach(mixed))["impact"]
    assert owned == ("marble_geom0", "cart_geom0", "bumper", "flag_geom0")


def test_unnamed_geoms_get_names_that_are_free() -> None:
    """A name in use is not taken again."""
    xml = free_ball(tail="").replace('name="ball"', "").replace("floor", "body_geom0")
    assert owned_geoms(attach(xml))["impact"] == ("body_geom1",)


def test_fixed_geoms_keep_their_margins(mixed: str) -> None:
    """Their contacts with geoms that are not owned must stay as they were."""
    before = mujoco.MjModel.from_xml_string(mixed)
    after = attach(mixed).compile()
    for name in ("floor", "ledge", "post"):
        assert margins(after, name) == margins(before, name)


@pytest.mark.parametrize(
    ("floor", "ball"),
    [("", ""), ('margin=".003"', ""), ("", 'margin=".003"'), ('gap=".01"', "")],
)
def test_contact_is_ours_from_the_gap_to_the_depth(floor: str, ball: str) -> None:
    """MuJoCo detects the contact and leaves it out of its solver in between."""
    spec = attach(free_ball(floor=floor, ball=ball, height=0.02), gap=2e-3, depth=5e-4)
    model = spec.compile()
    data = mujoco.MjData(model)
    for distance, detected in ((1.9e-3, True), (0.0, True), (-4.9e-4, True)):
        data.qpos[2] = 0.02 + distance
        mujoco.mj_forward(model, data)
        assert (data.ncon == 1) is detected
        assert data.contact.exclude[0] == 1
        assert data.contact.efc_address[0] == -1
        assert data.contact.includemargin[0] < 0
    data.qpos[2] = 0.02 + (2.2e-2 if floor or ball else 2.2e-3)
    mujoco.mj_forward(model, data)
    assert data.ncon == 0


def test_deeper_than_the_depth_mujoco_takes_over() -> None:
    """The safety net: an ordinary contact of the solver."""
    model = attach(free_ball(), depth=5e-4).compile()
    data = mujoco.MjData(model)
    data.qpos[2] = 0.02 - 6e-4
    mujoco.mj_forward(model, data)
    assert data.contact.exclude[0] == 0
    assert data.contact.efc_address[0] >= 0


def test_contact_between_two_owned_geoms_is_ours(two_balls: str) -> None:
    """Margins and gaps of the two geoms add up."""
    model = attach(two_balls, gap=3e-3, depth=1e-4).compile()
    data = mujoco.MjData(model)
    for distance in (5.9e-3, 0.0, -1.9e-4):
        data.qpos[:] = (5.1e-3 - distance, 0.0)
        mujoco.mj_forward(model, data)
        assert data.ncon == 1
        assert data.contact.efc_address[0] == -1


def test_explicit_pairs_of_owned_geoms_become_ours(mixed: str) -> None:
    """A pair overrides the margins of its geoms, so it is set as well."""
    model = attach(mixed, gap=3e-3, depth=1e-4).compile()
    assert model.pair_margin[0] == pytest.approx(-1e-4)
    assert model.pair_margin[0] + model.pair_gap[0] == pytest.approx(3e-3)


def test_only_the_chosen_geoms_are_owned(mixed: str) -> None:
    """In the order given, which is that of the setting alpha."""
    spec = attach(mixed, geoms=["bumper", "post"])
    assert owned_geoms(spec)["impact"] == ("bumper", "post")
    model = spec.compile()
    assert margins(model, "bumper")[0] < 0
    assert margins(model, "post")[0] < 0
    assert model.geom_margin[model.geom_bodyid == model.body("marble").id][0] == 0


def test_default_gap_covers_a_fall_through_the_scene() -> None:
    """The gap exceeds what a body falling through the whole scene moves in a step."""
    xml = free_ball(head='<option timestep="0.01"/><statistic extent="2"/>')
    model = attach(xml).compile()
    margin, gap = margins(model, "ball")
    needed = np.sqrt(2 * 9.81 * 2.0) * 0.01
    assert needed <= margin + gap <= 1.01 * needed


def row_of_balls(count: int, pitch: float) -> str:
    """Free balls of a radius of 2 cm side by side, centres `pitch` apart [m]."""
    balls = "".join(
        f'<body pos="{pitch * i!r} 0 .5"><freejoint/><geom size=".02"/></body>'
        for i in range(count)
    )
    return f"<mujoco><worldbody>{balls}</worldbody></mujoco>"


@pytest.mark.parametrize("count", [1, 50])
def test_the_default_depth_does_not_depend_on_the_number_of_geoms(count: int) -> None:
    """Pulses that come at once need no room: a tenth of a micrometre."""
    spec = attach(row_of_balls(count, 0.04))
    assert all(geom.margin == -1e-7 for geom in spec.geoms)


@pytest.mark.parametrize(
    ("overlap", "depth"), [(-1e-6, 1e-7), (1e-6, 1e-6), (1.9e-6, 1e-6), (3e-6, 1e-7)]
)
def test_the_default_depth_has_room_for_rounded_positions(
    overlap: float, depth: float
) -> None:
    """Of balls that are to touch; what overlaps more is not rounded, but pressed."""
    spec = attach(row_of_balls(3, 0.04 - overlap))
    assert all(geom.margin == -depth for geom in spec.geoms)


def test_long_pulses_get_a_larger_depth() -> None:
    """During a pulse of milliseconds the bodies overlap much more."""
    short = margins(attach(free_ball()).compile(), "ball")[0]
    long = margins(attach(free_ball(), duration=5e-3).compile(), "ball")[0]
    assert long < 10 * short < 0


def test_settings_reach_the_plugin(two_balls: str) -> None:
    """Numbers keep all their digits."""
    spec = attach(two_balls, restitution=0.1 + 0.2, passive=False, duration="paper")
    (plugin,) = spec.plugins
    assert dict(plugin.config) == {
        "restitution": "0.30000000000000004",
        "passive": "false",
        "duration": "paper",
    }


def test_result_survives_xml(mixed: str) -> None:
    """The scene written as MJCF and read again is the same model."""
    spec = attach(mixed, restitution=0.5)
    model = spec.compile()
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    np.testing.assert_allclose(again.geom_margin, model.geom_margin)
    np.testing.assert_allclose(again.pair_gap, model.pair_gap)
    assert again.nplugin == model.nplugin == 1
    assert again.nsensordata == model.nsensordata > 0


def test_callers_specification_stays_as_it_is(mixed: str) -> None:
    """The work is done on a copy."""
    spec = mujoco.MjSpec.from_string(mixed)
    before = spec.to_xml()
    attach(spec)
    assert spec.to_xml() == before


def test_two_instances_share_a_scene(two_balls: str) -> None:
    """They own different geoms under different names."""
    spec = attach(attach(two_balls, geoms="left"), geoms="right", name="second")
    assert owned_geoms(spec) == {"impact": ("left",), "second": ("right",)}
    assert spec.compile().nplugin == 2


def test_scene_file_keeps_its_includes_and_assets(tmp_path: Path) -> None:
    """Relative names are looked for beside the file, from any working directory."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "block.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    (tmp_path / "parts" / "body.xml").write_text(
        '<mujoco><worldbody><body name="b"><freejoint/>'
        '<geom type="mesh" mesh="block"/></body></worldbody></mujoco>'
    )
    scene = tmp_path / "scene.xml"
    scene.write_text(
        '<mujoco><asset><mesh name="block" file="block.obj"/></asset>'
        '<include file="parts/body.xml"/></mujoco>'
    )
    relative = os.path.relpath(scene)
    for source in (scene, str(scene), relative):
        spec = attach(source)
        assert owned_geoms(spec)["impact"] == ("b_geom0",)
        assert spec.compile().nplugin == 1


def test_detach_gives_back_the_scene_as_it_was(two_balls: str) -> None:
    """The motion is bit for bit that of the scene that was never touched."""
    plain = mujoco.MjModel.from_xml_string(two_balls)
    back = detach(attach(two_balls)).compile()
    assert back.nplugin == back.nsensor == back.ntuple == 0
    np.testing.assert_array_equal(states(back, 40), states(plain, 40))


def test_detach_takes_the_plugin_out_of_a_scene_that_was_read(two_balls: str) -> None:
    """In MJCF the sensor names the instance alone."""
    written = attach(two_balls).to_xml()
    back = detach(detach(written)).compile()
    assert back.nplugin == back.nsensor == back.ntuple == 0


def test_owned_geoms_that_never_meet_change_nothing() -> None:
    """With no contact, the motion is bit for bit that of stock MuJoCo."""
    xml = free_ball(
        tail="<!-- -->",
        head='<option integrator="Euler" wind=".3 .1 0" density="1.2"/>',
        height=50,
    )
    stock = mujoco.MjModel.from_xml_string(xml)
    ours = attach(xml).compile()
    np.testing.assert_array_equal(states(ours, 200), states(stock, 200))


def test_contacts_of_other_geoms_stay_with_mujoco() -> None:
    """A box that is not owned bounces bit for bit as without the plugin."""
    xml = free_ball(height=50).replace(
        "</worldbody>",
        '<body pos="0.5 0 .1"><freejoint/><geom type="box" size=".05 .04 .03"/></body>'
        "</worldbody>",
    )
    stock = mujoco.MjModel.from_xml_string(xml)
    ours = attach(xml, geoms=["ball"]).compile()
    np.testing.assert_array_equal(states(ours, 300), states(stock, 300))


def states(model: mujoco.MjModel, steps: int) -> np.ndarray:
    """Returns positions and velocities after each step, shape (steps, nq + nv)."""
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    rows = []
    for _ in range(steps):
        mujoco.mj_step(model, data)
        rows.append(np.concatenate([data.qpos, data.qvel]))
    return np.array(rows)


FLEX = """<worldbody><body name="rag" pos="0 0 .5"><freejoint/>
  <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" radius=".01"/>
</body></worldbody>"""

SUCTION = """<actuator>
  <adhesion name="suck" body="{body}" ctrlrange="0 1" gain="10"/>
</actuator>"""

REFUSED = {
    "override": (
        free_ball(head='<option><flag override="enable"/></option>'),
        'flag override="enable"',
    ),
    "no springs and dampers": (
        free_ball(head='<option><flag spring="disable" damper="disable"/></option>'),
        "calls no passive plugin",
    ),
    "no contacts": (
        free_ball(head='<option><flag contact="disable"/></option>'),
        'flag contact="disable"',
    ),
    "adhesion": (free_ball(ball='adhesion="1"'), "'ball' has adhesion 1"),
    "adhesion actuator": (
        free_ball(tail=SUCTION.format(body="cup")).replace(
            "<body ", '<body name="cup" '
        ),
        "adhesion actuator 'suck' of the body 'cup'",
    ),
    "adhesion actuator of what an owned geom can touch": (
        free_ball(tail=SUCTION.format(body="pad")).replace(
            "</worldbody>",
            '<body name="pad" pos="1 0 1"><geom size=".01"/></body></worldbody>',
        ),
        "adhesion actuator 'suck' of the body 'pad'",
    ),
    "tuple of that name": (
        free_ball(
            tail='<custom><tuple name="impact"><element objtype="geom" '
            'objname="ball"/></tuple></custom>'
        ),
        "already has a tuple 'impact'",
    ),
    "sensor of that name": (
        free_ball(tail='<sensor><clock name="impact"/></sensor>'),
        "already has a sensor 'impact'",
    ),
    "nothing moves": (
        '<mujoco><worldbody><geom size="1"/></worldbody></mujoco>',
        "no body of the scene that can move",
    ),
    "flex": (free_ball(tail=FLEX), "flex 'cloth'"),
    "not MJCF": ("<mujoco><ball/></mujoco>", "unrecognized element"),
    "cannot be compiled": (
        free_ball(ball='material="gold"'),
        "material 'gold' not found",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_scene_that_cannot_take_the_plugin_is_refused(case: str) -> None:
    """With the reason in the message."""
    xml, reason = REFUSED[case]
    with pytest.raises(SceneError) as caught:
        attach(xml)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_adhesion_actuator_elsewhere_is_no_reason_to_refuse() -> None:
    """What it acts on is not ours, and cannot touch what is."""
    xml = free_ball(tail=SUCTION.format(body="pad")).replace(
        "</worldbody>",
        '<body name="pad" pos="1 0 1"><freejoint/>'
        '<geom name="pad" size=".01" contype="2" conaffinity="2"/></body></worldbody>',
    )
    assert owned_geoms(attach(xml, geoms=["ball"]))["impact"] == ("ball",)
    with pytest.raises(SceneError, match="adhesion actuator"):
        attach(xml)


def test_geoms_owned_twice_are_refused(two_balls: str) -> None:
    """Two instances would both push them."""
    with pytest.raises(SceneError, match="'impact' of the scene already owns left"):
        attach(attach(two_balls), geoms=["left"], name="second")
    with pytest.raises(SceneError, match="already has a plugin instance 'impact'"):
        attach(attach(two_balls))


@pytest.mark.parametrize(
    ("geoms", "reason"),
    [
        (["bal"], r"no geom 'bal'; did you mean 'ball'\? \(available: floor, ball\)"),
        (["ball", "ball"], "'ball' is given twice"),
        ([], "at least one geom"),
    ],
)
def test_wrong_geom_names_are_refused(geoms: list[str], reason: str) -> None:
    """The message lists the names there are."""
    with pytest.raises(SceneError, match=reason):
        attach(free_ball(), geoms=geoms)


def test_geom_that_cannot_collide_is_refused(mixed: str) -> None:
    """Owning it would do nothing."""
    with pytest.raises(SceneError, match="'paint' cannot collide"):
        attach(mixed, geoms=["paint"])


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        ({"resitution": 0.9}, "did you mean 'restitution'"),
        ({"colour": "red"}, r"unknown setting 'colour' \(available: law, "),
        ({"gap": 0.0}, r"gap = 0.0: must be a length > 0 \[m\]"),
        ({"depth": float("nan")}, "depth = nan: must be a length"),
        ({"young": -1.0}, "'young' = '-1.0'"),
        ({"law": "newton"}, "'law' = 'newton'"),
        ({"restitution": 1.5}, "'restitution' = '1.5'"),
        ({"duration": None}, "'duration' = None must be text"),
        ({"gap": True}, "gap = True: must be a length"),
        ({"speed": 10**400}, "speed = 10+: must be a speed"),
        ({"depth": 1.0}, r"depth = 1.0: must be less than 0\.\d+ m, half of the width"),
        ({"materials": "steel"}, "materials = 'steel': must be a dict"),
        ({"assign": []}, r"assign = \[\]: must be a dict"),
        ({"pairs": ("a", "b")}, "pairs = .*: must be a dict"),
    ],
)
def test_wrong_settings_are_refused(settings: dict[str, object], reason: str) -> None:
    """The message names the setting, its value and what is allowed."""
    with pytest.raises(ConfigError, match=reason):
        attach(free_ball(), **settings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"name": ""}, "name = '': must be text"),
        ({"name": b"impact"}, "name = b'impact': must be text"),
        ({"geoms": 1}, "geoms = 1: must be names of geoms"),
        ({"geoms": [["ball"]]}, "there is no geom "),
    ],
)
def test_wrong_names_are_refused(options: dict[str, object], reason: str) -> None:
    """Every error is an ImpactError with one sentence."""
    with pytest.raises(SceneError, match=reason):
        attach(free_ball(), **options)  # type: ignore[arg-type]


def test_the_depth_is_less_than_half_of_the_smallest_owned_geom(two_balls: str) -> None:
    """Two of them then overlap by less than their width, and cannot change places."""
    model = attach(two_balls).compile()
    radius = float(model.geom_size[:, 0].min())
    assert attach(two_balls, depth=0.999 * radius).compile().nplugin == 1
    with pytest.raises(ConfigError, match=f"must be less than {radius:.4g} m"):
        attach(two_balls, depth=radius)


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("no_such_file.xml", "no model file 'no_such_file.xml'"),
        ("model.mjb", "compiled model"),
        (3, "got int"),
    ],
)
def test_wrong_sources_are_refused(source: object, reason: str) -> None:
    """Every error is an ImpactError with one sentence."""
    with pytest.raises(ImpactError, match=reason):
        attach(source)  # type: ignore[arg-type]
