"""Materials in `attach`: names, mistakes, models that are saved, attached, copied."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

import cradle_models
from mujoco_impact import MATERIALS, Material, MaterialPair, attach, compare, detach
from mujoco_impact.cli import app
from mujoco_impact.errors import ConfigError, ImpactError, SceneError
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.sensor import NUMBERS_PER_GEOM, sensor_slice

TABLE = """
<mujoco model="table">
  <option timestep=".002"/>
  <worldbody>
    <geom name="table" type="box" size="1 1 .1" pos="0 0 -.1"/>
    <geom name="paint" type="plane" size="1 1 .1" contype="0" conaffinity="0"/>
    {open}
    <body name="one" pos="0 0 .13"><freejoint/><geom name="ball_a" size=".03"/></body>
    <body name="two" pos=".2 0 .13"><freejoint/><geom name="ball_b" size=".03"/></body>
    {close}
  </worldbody>
</mujoco>
"""
SCENE = TABLE.format(open="", close="")
REPLICATED = TABLE.format(
    open='<replicate count="2" offset="0 .2 0" sep="-">', close="</replicate>"
)

OWN = {"bouncy": {"restitution": 0.9}, "dull": Material(restitution=0.5)}
ASSIGN = {"ball_a*": "bouncy", "ball_b*": "dull", "table": "bouncy"}


def attached(scene: str = SCENE, **options: Any) -> mujoco.MjSpec:
    """Returns the scene with two materials, equally stiff."""
    return attach(scene, materials=OWN, assign=ASSIGN, **options)


def speeds_after_impact(model: mujoco.MjModel) -> list[float]:
    """Returns the upward speeds of the balls after their first impact [m/s]."""
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 80)
    return [float(v) for v in np.sort(data.qvel.reshape(-1, 6)[:, 2])]


def test_names_and_patterns_say_of_which_material_a_geom_is() -> None:
    """The name of a geom counts more than a pattern, in any order."""
    for assign in (
        {"ball_*": "bouncy", "ball_b": "dull", "table": "bouncy"},
        {"ball_b": "dull", "table": "bouncy", "ball_*": "bouncy"},
    ):
        spec = attach(SCENE, materials=OWN, assign=assign)
        assert list(spec.tuples[0].objprm) == [1.0, 2.0, -1.0]
        assert list(spec.tuples[0].objname) == ["ball_a", "ball_b", "table"]


def test_a_geom_with_a_material_is_not_owned_for_that() -> None:
    """It stays out of the sensor, and can be of a material in another instance."""
    spec = attached()
    assert owned_geoms(spec) == {"impact": ("ball_a", "ball_b")}
    owned = sensor_slice(spec.compile())
    assert owned.stop - owned.start == 2 * NUMBERS_PER_GEOM
    first = attached(geoms=["ball_a"], name="first")
    second = attach(
        first, geoms=["ball_b"], name="second", materials=OWN, assign=ASSIGN
    )
    assert owned_geoms(second) == {"first": ("ball_a",), "second": ("ball_b",)}
    assert speeds_after_impact(second.compile()) == pytest.approx(
        speeds_after_impact(spec.compile()), rel=1e-12
    )


def test_detach_takes_materials_out() -> None:
    """Nothing of them is left."""
    spec = detach(attached())
    assert not spec.tuples
    assert not spec.plugins
    assert spec.compile().nplugin == 0


def test_without_materials_the_instance_says_nothing_of_them() -> None:
    """The attributes are absent, so nothing is read while a simulation runs."""
    assert dict(attach(SCENE).plugins[0].config) == {}


Change = Callable[[], mujoco.MjModel]


def saved(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Returns the model of the MJCF that the scene is saved as."""
    spec.compile()
    return mujoco.MjModel.from_xml_string(spec.to_xml())


def two_of_them() -> mujoco.MjSpec:
    """Returns a scene to which the table was attached twice."""
    parent = mujoco.MjSpec()
    parent.option.timestep = 0.002
    for number, prefix in enumerate(("left_", "right_")):
        frame = parent.worldbody.add_frame(pos=[0, 5.0 * number, 0])
        parent.attach(attached(), prefix=prefix, frame=frame)
    return parent


@pytest.mark.parametrize(
    ("change", "times"),
    [
        (lambda: saved(attached()), 1),
        (lambda: attached().copy().compile(), 1),
        (lambda: two_of_them().compile(), 2),
        (lambda: saved(two_of_them()), 2),
        (lambda: attached(REPLICATED).compile(), 2),
        (lambda: saved(attached(REPLICATED)), 2),
    ],
    ids=[
        "saved",
        "copied",
        "attached",
        "attached, saved",
        "replicated",
        "replicated, saved",
    ],
)
def test_materials_stay_in_a_scene_that_is(change: Change, times: int) -> None:
    """The balls leave the table with the restitution of each."""
    expected = speeds_after_impact(attached().compile())
    assert expected[0] < 0.8 * expected[1]
    found = speeds_after_impact(change())
    # MJCF keeps six digits of some numbers of the scene
    assert found == pytest.approx(np.repeat(expected, times), rel=1e-5)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"assign": {"ball_c": "steel"}}, SceneError, "no geom 'ball_c'.*'ball_a'"),
        ({"assign": {"bat*": "steel"}}, SceneError, "no geom 'bat\\*'"),
        ({"assign": {"ball_a": "stele"}}, ConfigError, "did you mean 'steel'"),
        ({"assign": {"ball_a": "gold"}}, ConfigError, "'gold'.*available: .*rubber"),
        (
            {"assign": {"ball_*": "steel", "*_a": "cork"}},
            ConfigError,
            "'ball_a' is of 'steel' by 'ball_\\*' and of 'cork' by '\\*_a'",
        ),
        ({"materials": {"gold": {}}}, ConfigError, "gold: no geom is of them"),
        (
            {"materials": {"gold": {"bounce": 1}}, "assign": {"ball_a": "gold"}},
            ConfigError,
            "material 'gold' has no 'bounce'.*available: restitution",
        ),
        (
            {"materials": {"gold": 0.5}, "assign": {"ball_a": "gold"}},
            ConfigError,
            "material 'gold' = 0.5: must be a Material",
        ),
        (
            {"materials": {"g": {"young": "soft"}}, "assign": {"ball_a": "g"}},
            ConfigError,
            "'g': young = 'soft' must be a number",
        ),
        ({"materials": {"a b": {}}}, ConfigError, "'a b' is no name of a material"),
        (
            {"materials": {"g": {"young": -1}}, "assign": {"ball_a": "g"}},
            ConfigError,
            "'g': young = '-1', must be a finite number > 0",
        ),
        (
            {"pairs": {("ball_a", "tabel"): {}}},
            ConfigError,
            "'tabel'.*neither a material nor a geom; did you mean 'table'",
        ),
        ({"pairs": {"ball_a": {}}}, ConfigError, "'ball_a' must be two names"),
        (
            {"pairs": {("ball_a", "table"): {"young": 1}}},
            ConfigError,
            "pair .'ball_a', 'table'. has no 'young'",
        ),
        (
            {"pairs": {("ball_a", "table"): {}, ("table", "ball_a"): {}}},
            ConfigError,
            "'ball_a' and 'table' are given twice",
        ),
        (
            {
                "assign": {"ball_a": "steel", "table": "cork"},
                "pairs": {
                    ("ball_a", "cork"): {"restitution": 0.1},
                    ("steel", "table"): {"restitution": 0.2},
                },
            },
            ConfigError,
            "'ball_a' and 'table' are of two pairs",
        ),
        (
            {"law": "calibrated", "sh": 1, "alpha": [1], "assign": {"ball_a": "steel"}},
            ConfigError,
            "only with law = 'hertz'",
        ),
    ],
)
def test_mistakes_are_named_with_what_is_available(
    options: dict[str, Any], error: type[ImpactError], text: str
) -> None:
    """Nothing that was asked for is left out silently."""
    with pytest.raises(error, match=text):
        attach(SCENE, **options)


@pytest.mark.parametrize("name", sorted(MATERIALS))
def test_every_material_that_ships_can_be_used(name: str) -> None:
    """And says what decides an impact: how stiff it is and what it gives back."""
    material = MATERIALS[name]
    assert material.young is not None
    assert material.restitution is not None
    assert attach(SCENE, assign={"*": name}).compile().nplugin == 1


def test_instances_whose_geoms_meet_must_say_the_same_of_pairs() -> None:
    """What counts between two of their geoms would depend on their order."""
    pairs = {("bouncy", "dull"): MaterialPair(restitution=0.1)}
    first = attached(geoms=["ball_a"], name="first", pairs=pairs)
    with pytest.raises(ConfigError, match="different settings"):
        attach(first, geoms=["ball_b"], name="second", materials=OWN, assign=ASSIGN)


def test_a_comparison_knows_no_reference_for_different_materials() -> None:
    """It would be that of one material."""
    told = compare(attached(), duration=0.2, repeats=1)
    assert "different materials" in told.note
    row = attach(cradle_models.model_path("row_3"), assign={"ball_1": "rubber"})
    told = compare(row, duration=0.3, keyframe="release", repeats=1)
    assert "different materials" in told.note


def test_the_command_line_gives_materials(tmp_path: Path) -> None:
    """To a scene that is written, by names and patterns."""
    scene, out = tmp_path / "scene.xml", tmp_path / "out.xml"
    scene.write_text(SCENE)
    arguments = ["attach", str(scene), "-o", str(out), "--material"]
    done = CliRunner().invoke(
        app, [*arguments, "ball_*=rubber", "--material", "table=wood"]
    )
    assert done.exit_code == 0, done.output
    spec = mujoco.MjSpec.from_file(str(out))
    assert list(spec.tuples[0].objprm) == [1.0, 1.0, -2.0]
    twice = [*arguments, "ball_a=rubber", "--material", "ball_a=wood"]
    done = CliRunner().invoke(app, twice)
    assert done.exit_code != 0
    assert "'ball_a' is of 'rubber' and of 'wood'" in done.output
    done = CliRunner().invoke(app, [*arguments, "rubber"])
    assert done.exit_code != 0
    assert "must be GEOM=NAME" in done.output
