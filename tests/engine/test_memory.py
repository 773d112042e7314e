"""Too little memory in mjData costs impacts and says so; the process goes on."""

import subprocess
import sys

import cradle_models
import mujoco_impact

BALLS = 30

# More than MuJoCo itself needs for these balls, less than their impacts take.
SHORT = "60K"
AMPLE = "1M"

PROGRAM = """
import sys
import mujoco
import mujoco_impact
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
mujoco.mj_step(model, data, 200)
print(abs(data.qvel[-1]) > 0.1)
"""


def last_ball_flies(memory, folder):
    # a depth within which the impacts can wait: deeper they are MuJoCo's
    xml = mujoco_impact.attach(cradle_models.row("A" * BALLS), depth=5e-3).to_xml()
    scene = folder / "scene.xml"
    scene.write_text(xml.replace("<size ", f'<size memory="{memory}" ', 1))
    # in a process of its own, for MuJoCo ends it when its stack overflows
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(scene)],
        capture_output=True, text=True, cwd=folder, timeout=60, check=True,
    )  # fmt: skip
    return done.stdout.strip(), done.stderr


def test_impacts_without_memory_wait_and_say_so(tmp_path):
    flies, message = last_ball_flies(SHORT, tmp_path)
    assert flies == "False"
    assert "need more memory than mjData has left" in message
    assert "raise <size memory" in message


def test_impacts_with_memory_need_no_warning(tmp_path):
    assert last_ball_flies(AMPLE, tmp_path) == ("True", "")
