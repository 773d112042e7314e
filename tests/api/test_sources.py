"""How scenes come in: every instance of the plugin survives, or is refused in words."""

from __future__ import annotations

import copy
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

import mujoco_impact
from mujoco_impact import attach, compare, run
from mujoco_impact.baselines import baselines
from mujoco_impact.cli import app
from mujoco_impact.errors import SceneError
from mujoco_impact.instances import our_instances
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.scene import detach
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import copy_spec
from mujoco_impact.stress import stress_scene

PLUGIN = "mujoco_impact.waveform"

NAMED_BY: dict[str, dict[str, str]] = {
    "nothing": {},
    "a sensor": {"sensor": f'<plugin plugin="{PLUGIN}" instance="impact"/>'},
    "a sensor, by instance alone": {"sensor": '<plugin instance="impact"/>'},
    "a body": {"body": f'<plugin plugin="{PLUGIN}" instance="impact"/>'},
    "a body, by instance alone": {"body": '<plugin instance="impact"/>'},
    "a body and a sensor": {
        "body": '<plugin instance="impact"/>',
        "sensor": '<plugin instance="impact"/>',
    },
}
"""Who names the plugin instance of a scene, and how."""


def scene(
    *,
    body: str = "",
    sensor: str = "",
    instance: str = '<instance name="impact"><config key="restitution" value=".5"/>'
    "</instance>",
) -> str:
    """Returns two balls on a rail whose contact is the plugin's."""
    return f"""<mujoco>
  <extension><plugin plugin="{PLUGIN}">{instance}</plugin></extension>
  <option gravity="0 0 0"/>
  <default>
    <geom size=".015" margin="-.0002" gap=".008"/><joint type="slide" axis="1 0 0"/>
  </default>
  <worldbody>
    <body name="left" pos="-.05 0 0">{body}<joint/><geom name="left"/></body>
    <body name="right"><joint/><geom name="right"/></body>
  </worldbody>
  <sensor>{sensor}</sensor>
  <keyframe><key name="shot" qvel=".5 0"/></keyframe>
</mujoco>"""


@pytest.fixture(params=NAMED_BY)
def xml(request: pytest.FixtureRequest) -> str:
    """A scene whose author named the instance in one of these ways, or not at all."""
    return scene(**NAMED_BY[request.param])


def test_every_way_in_keeps_the_impacts(xml: str, tmp_path: Path) -> None:
    """A file, text, a specification, copies of it, and a compiled model."""
    path = tmp_path / "scene.xml"
    path.write_text(xml)
    spec = mujoco.MjSpec.from_string(xml)
    compiled = mujoco.MjSpec.from_string(xml)
    model = compiled.compile()
    sources = (path, str(path), xml, spec, copy_spec(spec), compiled, model)
    motions = [run(one, duration=0.2, keyframe="shot") for one in sources]
    for motion in motions:
        assert len(motion.impacts) == 1
        np.testing.assert_array_equal(motion.qvel[-1], motions[0].qvel[-1])
    many = [
        mujoco_impact.rollout(one, duration=0.2, keyframe="shot", threads=1)
        for one in sources
    ]
    for rollouts in many:
        np.testing.assert_array_equal(rollouts.qvel[0, -1], motions[0].qvel[-1])


def test_compiled_files_keep_the_impacts_or_are_refused(
    xml: str, tmp_path: Path
) -> None:
    """A .mjb is for `MjModel.from_binary_path`; the model it gives runs as ever."""
    path = tmp_path / "scene.mjb"
    mujoco.mj_saveModel(mujoco.MjSpec.from_string(xml).compile(), str(path))
    model = mujoco.MjModel.from_binary_path(str(path))
    assert len(run(model, duration=0.2, keyframe="shot").impacts) == 1
    for ask in (attach, detach, read_spec):
        with pytest.raises(SceneError, match="is a compiled model"):
            ask(path)
        with pytest.raises(SceneError, match="got MjModel"):
            ask(model)


def test_commands_keep_the_impacts(xml: str, tmp_path: Path) -> None:
    """`run` takes the scene as it is; `stress` sees that it has the plugin."""
    path = tmp_path / "scene.xml"
    path.write_text(xml)
    start = ("--keyframe", "shot", "--duration", "0.2")
    result = CliRunner().invoke(app, ["run", str(path), *start])
    assert result.exit_code == 0, result.output
    assert "impacts: 1" in result.output
    result = CliRunner().invoke(app, ["stress", str(path), *start])
    assert "as it is" in result.output
    assert "restitution" not in result.output  # tried for scenes without the plugin


def test_stress_and_compare_keep_the_impacts_of_a_specification(xml: str) -> None:
    """`compare` puts its own instance in the place of those of the scene."""
    spec = mujoco.MjSpec.from_string(xml)
    findings = stress_scene(spec, duration=0.2, keyframe="shot")
    assert findings[0].impacts == 1
    comparison = compare(spec, duration=0.2, keyframe="shot", repeats=1)
    assert comparison.geoms == ("left", "right")
    assert len(comparison.methods[0].trajectory.impacts) == 1


def test_detach_takes_the_instance_out_whoever_names_it(xml: str) -> None:
    """And leaves a scene that compiles and can be given to the plugin again."""
    plain = detach(mujoco.MjSpec.from_string(xml))
    model = plain.compile()
    assert model.nplugin == model.nsensor == 0
    assert not np.any(model.geom_margin)
    assert plain.copy().compile().nplugin == 0
    again = attach(plain)
    assert owned_geoms(again) == {"impact": ("left", "right")}
    assert run(again, duration=0.2, keyframe="shot").impacts


def test_attach_sees_the_instance_whoever_names_it(xml: str) -> None:
    """An instance without a tuple owns every geom."""
    for source in (xml, mujoco.MjSpec.from_string(xml)):
        with pytest.raises(SceneError, match=r"already (has|owns)"):
            attach(source, name="other")


def test_an_instance_that_nothing_names_keeps_its_settings() -> None:
    """Beside one that has a sensor, and under its own name."""
    tuples = "".join(
        f'<tuple name="{name}"><element objtype="geom" objname="{geom}"/></tuple>'
        for name, geom in (("impact", "left"), ("second", "right"))
    )
    settings = '<config key="restitution" value=".25"/>'
    xml = scene(
        instance=f'<instance name="second">{settings}</instance>'
        f'<instance name="impact">{settings}</instance>',
        sensor='<plugin instance="impact"/>' * 2,
    ).replace("<sensor>", f"<custom>{tuples}</custom><sensor>")
    spec = mujoco.MjSpec.from_string(xml)
    copied = copy_spec(spec)
    assert owned_geoms(copied) == {"impact": ("left",), "second": ("right",)}
    assert dict(copied.plugin("second").config) == {"restitution": ".25"}
    assert copied.compile().nplugin == 2
    assert baselines(copied, impact_speed=1.0)[0].spec.compile().nplugin == 0


@pytest.mark.parametrize("place", ["body", "sensor"])
def test_an_instance_without_a_name_is_refused(place: str) -> None:
    """Geoms are owned by name; `MjSpec.copy` of such a body ends in a wrong model."""
    xml = scene(instance="", **{place: f'<plugin plugin="{PLUGIN}"/>'})
    for source in (xml, mujoco.MjSpec.from_string(xml)):
        for use in (attach, detach, lambda one: run(one, duration=0.1)):
            with pytest.raises(SceneError, match=f"{place} .* without an instance"):
                use(source)


def test_instances_of_other_plugins_are_kept() -> None:
    """Named by nothing, or had by an element to itself: MuJoCo's copy loses both."""
    pid = '<plugin plugin="mujoco.pid" joint="hinge"/>'
    spec = mujoco.MjSpec.from_string(
        f"""<mujoco><extension>
          <plugin plugin="mujoco.sdf.torus"><instance name="other"/></plugin>
          <plugin plugin="mujoco.pid"/>
        </extension>
        <worldbody>
          <body><joint name="hinge"/><geom name="one" size=".1"/></body>
          <body><freejoint/><geom name="two" size=".1"/></body>
        </worldbody>
        <actuator>{pid}{pid}</actuator></mujoco>"""
    )
    spec = attach(attach(spec, geoms=["one"]), geoms=["two"], name="second")
    assert spec.compile().nplugin == 5
    assert our_instances(spec) == ["impact", "second"]
    assert detach(spec).compile().nplugin == 3


BROKEN = {
    "sensor": '<sensor><touch name="lost" site="nowhere"/></sensor>',
    "actuator": '<actuator><motor name="lost" joint="nowhere"/></actuator>',
    "pair": '<contact><pair name="lost" geom1="ball" geom2="nowhere"/></contact>',
    "exclude": '<contact><exclude name="lost" body1="b" body2="nowhere"/></contact>',
    "equality": '<equality><weld name="lost" body1="b" body2="nowhere"/></equality>',
    "tuple": '<custom><tuple name="lost"><element objtype="geom" objname="nowhere"/>'
    "</tuple></custom>",
}
"""Elements that name what is not there."""


@pytest.mark.parametrize("kind", BROKEN)
@pytest.mark.parametrize("use", [attach, detach, lambda spec: run(spec, duration=0.1)])
def test_an_element_is_not_lost_in_silence(
    kind: str, use: Callable[[mujoco.MjSpec], object]
) -> None:
    """MuJoCo's copy leaves out what names something that is not there."""
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><body name="b"><freejoint/><geom name="ball" size=".1"/>'
        f"</body></worldbody>{BROKEN[kind]}</mujoco>"
    )
    with pytest.raises(SceneError, match="'lost'") as caught:
        use(spec)
    assert "\n" not in str(caught.value)


CHAINS = """
import gc, mujoco, mujoco_impact
from mujoco_impact.envs import cradle_model
from mujoco_impact.instances import our_instances
from mujoco_impact.scene import detach

count = 8
balls = "".join(
    f'<body pos="{i} 0 0"><freejoint/><geom name="ball_{i}" size=".1"/></body>'
    for i in range(count)
)
names = [f"an_instance_with_a_long_name_{i}" for i in range(count)]
spec = f"<mujoco><worldbody>{balls}</worldbody></mujoco>"
for i, name in enumerate(names):
    spec = mujoco_impact.attach(spec, geoms=[f"ball_{i}"], name=name)
    gc.collect()
    if MUJOCO_COPIES:
        spec = spec.copy()
        gc.collect()
    assert our_instances(spec) == names[: i + 1], our_instances(spec)
if not MUJOCO_COPIES:
    # also for whoever reads them by themselves
    assert {one.plugin_name for one in spec.plugins} == {"mujoco_impact.waveform"}
model = spec.compile()
assert model.nplugin == count
assert [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_PLUGIN, i)
        for i in range(count)] == names
assert mujoco_impact.run(spec, duration=0.01).time[-1] > 0
plain = detach(spec)
del spec
gc.collect()
assert plain.compile().nplugin == 0
assert our_instances(mujoco_impact.attach(plain)) == ["impact"]
print("sound")
"""


@pytest.mark.parametrize("mujoco_copies", [False, True])
def test_chains_of_copies_are_sound_when_their_sources_are_gone(
    mujoco_copies: bool,
) -> None:
    """One instance per material; freed memory is overwritten, so that reading it shows.

    The two variables tell the C library to do so at once; another one ignores them.
    """
    environment = {
        **os.environ,
        "MALLOC_PERTURB_": "165",
        "GLIBC_TUNABLES": "glibc.malloc.tcache_count=0",
    }
    code = f"MUJOCO_COPIES = {mujoco_copies}\n{CHAINS}"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment
    )
    assert done.stdout == "sound\n", done.stderr


def test_a_copy_names_instances_of_a_source_that_is_gone() -> None:
    """Named by instance alone, its text is asked of the compiler."""
    spec = mujoco.MjSpec.from_string(scene(sensor='<plugin instance="impact"/>'))
    copied = spec.copy()
    spec.plugins[0].plugin_name = "gone"  # what a copy of MuJoCo's reads, too
    assert our_instances(copied) == ["impact"]
    assert len(run(copied, duration=0.2, keyframe="shot").impacts) == 1


def test_models_stay_as_they_are(two_balls: str) -> None:
    """`run` and `rollout` work on copies of a compiled model."""
    model = attach(two_balls).compile()
    before = copy.copy(model)
    run(model, duration=0.02)
    mujoco_impact.rollout(model, duration=0.02, threads=1)
    assert model.opt.enableflags == before.opt.enableflags


def test_a_model_without_a_name_is_called_as_its_file(tmp_path):
    """In tables, pictures and reports."""
    path = tmp_path / "two.xml"
    path.write_text('<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>')
    assert read_spec(path).modelname == "two"
