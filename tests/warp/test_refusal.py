"""Engines without plugins do not get a model whose impacts are ours."""

import subprocess
import sys

import mujoco
import pytest

import cradle_models
import mujoco_impact

BALLS = """<mujoco>
  <extension>
    <plugin plugin="mujoco_impact.waveform"><instance name="impact"/></plugin>
  </extension>
  <worldbody>
    <body><plugin plugin="mujoco_impact.waveform" instance="impact"/>
      <joint type="slide"/><geom size=".1" margin="-.001" gap=".1"/></body>
  </worldbody>
</mujoco>"""


def attached():
    return mujoco_impact.attach(cradle_models.model_path("row_3"))


def warp():
    return pytest.importorskip("mujoco_warp").put_model


def mjx():
    return pytest.importorskip("mujoco.mjx").put_model


def mjx_on_warp():
    put_model = mjx()
    return lambda model: put_model(model, impl="warp")


ENGINES = pytest.mark.parametrize("engine", [warp, mjx, mjx_on_warp])


@ENGINES
def test_a_model_with_the_sensor_is_refused_with_the_way_out(engine):
    put_model = engine()
    with pytest.raises(mujoco_impact.ImpactError, match="instance 'impact'") as error:
        put_model(attached().compile())
    assert "mujoco_impact.warp" in str(error.value)
    assert "mujoco_impact.detach" in str(error.value)


@ENGINES
def test_an_instance_that_a_body_carries_is_refused_just_so(engine):
    put_model = engine()
    with pytest.raises(mujoco_impact.ImpactError, match=r"mujoco_impact\.detach"):
        put_model(mujoco.MjModel.from_xml_string(BALLS))


@ENGINES
def test_a_model_whose_sensor_was_removed_is_refused(engine):
    put_model = engine()
    spec = attached()
    for sensor in list(spec.sensors):
        spec.delete(sensor)
    model = spec.compile()
    # the compiler has dropped the instance: nothing but the margins is left
    assert model.nplugin == 0
    with pytest.raises(mujoco_impact.ImpactError, match="Keep the sensor"):
        put_model(model)


@ENGINES
def test_a_detached_model_is_taken(engine):
    put_model = engine()
    model = mujoco_impact.detach(attached()).compile()
    assert put_model(model).nbody == model.nbody


@pytest.mark.parametrize(
    ("library", "first"),
    [
        ("mujoco_warp", "mujoco_impact"),
        ("mujoco_warp", "engine"),
        ("mujoco.mjx", "mujoco_impact"),
    ],
)
def test_the_refusal_is_there_whichever_is_imported_first(library, first):
    pytest.importorskip(library)
    imports = [f"import {library} as engine", "import mujoco_impact"]
    if first == "mujoco_impact":
        imports.reverse()
    script = "\n".join([*imports, "print(engine.put_model.refuses_impacts)"])
    found = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert found.stdout.strip().endswith("True"), found.stderr


UNREGISTERED = """
import sys, mujoco
try:
    mujoco.MjModel.from_xml_path(sys.argv[1])
except ValueError as error:
    print(error)
"""


def test_a_process_without_the_package_cannot_load_the_scene(tmp_path):
    path = tmp_path / "scene.xml"
    path.write_text(attached().to_xml())
    found = subprocess.run(
        [sys.executable, "-c", UNREGISTERED, str(path)],
        capture_output=True,
        text=True,
        check=False,
    )
    # MuJoCo 4 registers the plugin by itself
    if int(mujoco.mj_versionString()[0]) < 4:
        assert "plugin" in found.stdout, found.stderr
