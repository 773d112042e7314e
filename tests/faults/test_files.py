"""Damaged files: each is an error of this package that says what is wrong."""

import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import cradle_models
import mujoco_impact
from mujoco_impact import calibration
from mujoco_impact.cli import app
from mujoco_impact.errors import ImpactError

# the same damage in every run
examples = settings(max_examples=60, deadline=None, derandomize=True)

MODEL = cradle_models.model_path("row_3").read_bytes()


@st.composite
def damages(draw):
    """Cut off, overwritten, or with a piece of itself in the wrong place."""
    kind = draw(st.sampled_from(("cut", "overwrite", "insert", "noise")))
    where, size = draw(st.floats(0, 1)), draw(st.integers(1, 40))
    noise = draw(st.binary(min_size=size, max_size=size))

    def damage(content: bytes) -> bytes:
        at = int(where * len(content))
        if kind == "cut":
            return content[:at]
        if kind == "overwrite":
            return content[:at] + noise + content[at + size :]
        if kind == "insert":
            return content[:at] + content[:size] + content[at:]
        return noise

    return damage


def attempt(action) -> None:
    """Whatever is wrong is an ImpactError with a text of one line."""
    message = "fine"
    try:
        action()
    except ImpactError as error:
        message = str(error)
    assert message
    assert "\n" not in message


@examples
@given(damages())
def test_damaged_models(tmp_path_factory, damage):
    path = tmp_path_factory.mktemp("model") / "row.xml"
    path.write_bytes(damage(MODEL))
    attempt(lambda: mujoco_impact.attach(path).compile())


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory) -> bytes:
    motion = mujoco_impact.run(
        mujoco_impact.attach(cradle_models.model_path("row_3")),
        duration=0.3,
        keyframe="release",
    )
    return motion.save(tmp_path_factory.mktemp("run") / "motion.npz").read_bytes()


@examples
@given(damages())
def test_damaged_trajectories(trajectory, tmp_path_factory, damage):
    path = tmp_path_factory.mktemp("trajectory") / "motion.npz"
    path.write_bytes(damage(trajectory))
    attempt(lambda: mujoco_impact.Trajectory.load(path))


@pytest.fixture(scope="module")
def shots(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("shots") / "shots.csv"
    result = CliRunner().invoke(app, ["shots", "AAA", "--out", str(path)])
    assert result.exit_code == 0, result.output
    return path.read_bytes()


@examples
@given(damages())
def test_damaged_measurements(shots, tmp_path_factory, damage):
    path = tmp_path_factory.mktemp("csv") / "shots.csv"
    path.write_bytes(damage(shots))
    attempt(lambda: calibration.read_shots(path))


PARAMETERS = """{
  "format": "mujoco-impact parameters 1",
  "parameters": {"alpha": [1.0, 0.9], "sh": 190.0, "sw": 0.4, "w0": 0.0075,
                 "kappa": 0.083, "e": 0.9}
}"""


@examples
@given(damages())
def test_damaged_parameters(tmp_path_factory, damage):
    path = tmp_path_factory.mktemp("json") / "params.json"
    path.write_bytes(damage(PARAMETERS.encode()))
    attempt(lambda: calibration.read_parameters(path))


@pytest.mark.parametrize("command", ["run", "compare", "stress"])
@pytest.mark.parametrize("content", [b"", b"<mujoco>", b"\0\xff" * 100, MODEL[:500]])
def test_commands_say_in_one_sentence_what_is_wrong_with_a_model(
    command, content, tmp_path
):
    path = tmp_path / "broken.xml"
    path.write_bytes(content)
    result = CliRunner().invoke(app, [command, str(path)])
    assert result.exit_code == 2
    assert isinstance(result.exception, SystemExit)
    assert "broken.xml" in result.output
    assert "Traceback" not in result.output


def test_a_compiled_model_is_refused_with_what_to_give_instead(tmp_path):
    path = tmp_path / "row.mjb"
    mujoco.mj_saveModel(mujoco_impact.attach(MODEL.decode()).compile(), str(path))
    result = CliRunner().invoke(app, ["run", str(path)])
    assert result.exit_code == 2
    assert "give the MJCF file" in " ".join(result.output.split())


STEP_A_BINARY = """
import sys, numpy as np, mujoco{plugin}
model = mujoco.MjModel.from_binary_path(sys.argv[1])
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
mujoco.mj_step(model, data, nstep=200)
print(data.qpos.tobytes().hex(), int(data.plugin_state[1]))
"""


def in_a_process(code: str, path: Path) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True
    )


def test_a_compiled_model_runs_where_the_package_is_imported_first(tmp_path):
    """Without it MuJoCo itself has no such plugin; see plugin/README.md."""
    model = mujoco_impact.attach(MODEL.decode()).compile()
    path = tmp_path / "row.mjb"
    mujoco.mj_saveModel(model, str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=200)
    done = in_a_process(STEP_A_BINARY.format(plugin=", mujoco_impact"), path)
    assert done.returncode == 0, done.stderr
    qpos, impacts = done.stdout.split()
    np.testing.assert_array_equal(np.frombuffer(bytes.fromhex(qpos)), data.qpos)
    assert int(impacts) > 0
