"""The live view: what its keys do, and that its window opens on a display."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

import mujoco_impact
from mujoco_impact.cli import app
from mujoco_impact.viewer.session import KEYS, SPEEDS, Session

CODES = {key.name: key.code for key in KEYS}

BOUNCE = """
<mujoco model="bounce">
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="ball" pos="0 0 .5"><freejoint/><geom name="ball" size=".05"/></body>
  </worldbody>
  <keyframe>
    <key name="high" qpos="0 0 .5 1 0 0 0"/>
    <key name="low" qpos="0 0 .1 1 0 0 0"/>
  </keyframe>
</mujoco>
"""

FALL = np.sqrt(2 * 0.45 / 9.81)
"""Time of the first impact [s]."""


@pytest.fixture
def session() -> Session:
    return Session(mujoco_impact.attach(BOUNCE, restitution=1.0), keyframe="high")


def press(session: Session, *names: str) -> None:
    for name in names:
        session.press(CODES[name])


def speeds_of_impact(session: Session) -> tuple[float, float]:
    """Speeds just before and just after the next impact [m/s]."""
    count = session.impacts
    while session.impacts == count:
        before = session.data.qvel[2]
        session.step()
    session.step()
    return -before, session.data.qvel[2]


def test_time_passes_as_fast_as_asked(session: Session) -> None:
    """A second by the clock; the keys slow it down and stop it."""
    session.advance(0.2)
    assert session.data.time == pytest.approx(0.2, abs=0.002)
    press(session, "-")
    session.advance(0.2)
    assert session.data.time == pytest.approx(0.3, abs=0.003)
    press(session, "space")
    session.advance(1.0)
    assert session.data.time == pytest.approx(0.3, abs=0.003)
    press(session, ".")
    assert session.data.time == pytest.approx(0.302, abs=0.003)
    press(session, "space", *["="] * 20)
    assert session.speed == SPEEDS[-1]


def test_impacts_are_counted_and_the_latest_is_told(session: Session) -> None:
    session.advance(FALL - 0.01)
    assert dict(session.lines())["impacts"] == "0"
    session.advance(0.02)
    assert session.impacts == 1
    assert session.latest is not None
    # both ways at the speed of the fall: 2 m v
    expected = 2 * session.model.body("ball").mass[0] * 9.81 * FALL
    assert session.latest.impulse == pytest.approx(expected, rel=0.01)
    assert dict(session.lines())["impacts"].startswith("1, latest floor - ball:")
    assert len(session.recent) == 1
    session.advance(0.5)
    assert len(session.recent) == 0


def test_keys_set_the_restitution(session: Session) -> None:
    """Two presses of 8 take 0.2 off; the motion goes on from the same state."""
    session.advance(0.1)
    state = session.data.qpos.copy(), session.data.time
    press(session, "8", "8")
    assert session.restitution == 0.8
    assert (session.data.qpos == state[0]).all()
    assert session.data.time == state[1]
    before, after = speeds_of_impact(session)
    # gravity within two steps: 0.04 m/s of 3 m/s
    assert after / before == pytest.approx(0.8, abs=0.02)
    press(session, *["8"] * 20)
    assert session.restitution == 0
    press(session, *["9"] * 20)
    assert session.restitution == 1


def test_a_key_gives_the_contacts_to_mujoco_and_back(session: Session) -> None:
    """Under MuJoCo's contacts the ball stays on the floor, and no impact is counted."""
    press(session, "enter")
    session.advance(1.0)
    assert session.impacts == 0
    assert abs(session.data.qpos[2] - 0.05) < 0.01
    native = mujoco.MjModel.from_xml_string(BOUNCE)
    data = mujoco.MjData(native)
    mujoco.mj_resetDataKeyframe(native, data, 0)
    while data.time < session.data.time:
        mujoco.mj_step(native, data)
    # the floor and the ball are those of the file, to the last bit
    assert (session.data.qpos == data.qpos).all()
    press(session, "enter", "6")
    _, after = speeds_of_impact(session)
    assert after > 2.5


def test_keys_start_again_and_go_through_the_keyframes(session: Session) -> None:
    session.advance(0.4)
    press(session, "6")
    assert session.data.time == 0
    assert session.data.qpos[2] == 0.5
    assert session.impacts == 0
    press(session, "7")
    assert session.data.qpos[2] == 0.1
    assert session.lines()[-1] == ("", "from keyframe 'low'")
    press(session, "7")
    assert session.data.qpos[2] == 0.5


def test_a_reset_by_the_window_is_seen(session: Session) -> None:
    """MuJoCo's viewer resets the data itself."""
    session.advance(0.4)
    assert session.impacts == 1
    mujoco.mj_resetData(session.model, session.data)
    session.advance(FALL + 0.01)
    assert session.impacts == 1


def test_a_law_without_restitution_says_so() -> None:
    """The plugin refuses the setting; the motion goes on as it was."""
    spec = mujoco_impact.attach(BOUNCE, law="calibrated", sh=3.0, sw=1e-3)
    session = Session(spec, keyframe="high")
    press(session, "8")
    session.advance(0.1)
    assert session.data.time == pytest.approx(0.1, abs=0.003)


def test_no_key_is_one_of_mujocos() -> None:
    """Letters and digits up to 5 are taken, and signs that name what is drawn."""
    taken = {row[2] for row in (*mujoco.mjVISSTRING, *mujoco.mjRNDSTRING)}
    assert not taken & {key.name for key in KEYS}
    assert not {key.name for key in KEYS} & set("012345")


def test_without_a_display_one_sentence_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if sys.platform != "linux":
        pytest.skip("only Linux has displays that may be missing")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    result = CliRunner().invoke(app, ["view", "row_3"])
    assert result.exit_code == 2
    assert "there is no display" in result.stderr
    assert "mujoco-impact video" in result.stderr
    assert result.stderr.count("\n") == 1


@pytest.fixture
def display(tmp_path: Path) -> Iterator[dict[str, str]]:
    """A display without a screen; yields the environment that leads to it."""
    for tool in ("Xvfb", "xdotool"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed (Debian: apt install xvfb xdotool)")
    words = ["Xvfb", "-displayfd", "1", "-screen", "0", "900x600x24"]
    with subprocess.Popen(
        [*words, "-fbdir", str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as server:
        assert server.stdout is not None
        number = server.stdout.readline().strip()
        yield {"DISPLAY": f":{number}", "MUJOCO_GL": ""}
        server.terminate()


def pixels(tmp_path: Path) -> np.ndarray:
    """The screen as Xvfb keeps it: a file in the format of xwd."""
    content = (tmp_path / "Xvfb_screen0").read_bytes()
    header = np.frombuffer(content, ">u4", 25)
    start, width, height = int(header[0] + 12 * header[19]), header[4], header[5]
    image = np.frombuffer(content, np.uint8, int(height * header[12]), start)
    return image.reshape(height, -1, 4)[:, :width, :3]


def test_the_window_opens_takes_keys_and_closes(
    display: dict[str, str], tmp_path: Path
) -> None:
    """Pause, and MuJoCo's contacts instead of ours; the window closes by itself."""
    environment = {**os.environ, **display}

    def tool(*words: str) -> None:
        subprocess.run(["xdotool", *words], env=environment, check=True, timeout=60,
                       stdout=subprocess.DEVNULL)  # fmt: skip

    with subprocess.Popen(
        [sys.executable, "-m", "mujoco_impact", "view", "row_3", "--seconds", "6"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as command:
        tool("search", "--sync", "--onlyvisible", "--name", "MuJoCo")
        time.sleep(2)
        tool("key", "Return")
        tool("key", "space")
        time.sleep(2)
        shown = pixels(tmp_path)
        out, err = command.communicate(timeout=60)
    assert command.returncode == 0, err
    assert "contacts: MuJoCo's own" in out
    assert "paused" in out
    assert err == ""
    # text, sky, balls: not one colour
    assert len(np.unique(shown.reshape(-1, 3), axis=0)) > 50
