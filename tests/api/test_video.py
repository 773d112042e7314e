"""Videos: what is seen is where it is, and what cannot be drawn is said."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner, Result

import mujoco_impact
from mujoco_impact import Trajectory, video
from mujoco_impact.cli import app
from mujoco_impact.errors import (
    ConfigError,
    MissingExtraError,
    RenderingError,
    SceneError,
)
from mujoco_impact.video import opengl
from mujoco_impact.video.camera import Projection, camera_of
from mujoco_impact.video.scenes import native_panel

imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
Image = pytest.importorskip("PIL.Image")

BALL_AND_WALL = """
<mujoco model="ball_and_wall">
  <option gravity="0 0 0"/>
  <worldbody>
    <camera name="front" pos="0 -1 0" xyaxes="1 0 0 0 0 1"/>
    <geom name="wall" type="box" size=".02 .1 .1" pos=".3 0 0" rgba=".3 .3 .3 1"/>
    <body name="ball" pos="-.2 0 .1"><freejoint/>
      <geom name="ball" size=".03" rgba="0 0 1 1"/></body>
  </worldbody>
  <keyframe><key name="shot" qvel="1 0 0 0 0 0" qpos="-.2 0 0 1 0 0 0"/></keyframe>
</mujoco>
"""

ARROW = np.array([214, 39, 40])


@pytest.fixture
def gl(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that renders; the tests are run with rendering switched off."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    try:
        opengl.backend_name()
    except RenderingError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def scene() -> mujoco.MjSpec:
    return mujoco_impact.attach(BALL_AND_WALL)


@pytest.fixture(scope="module")
def motion(scene: mujoco.MjSpec) -> Trajectory:
    """The ball comes in at 1 m/s, meets the wall at 0.45 s and goes back."""
    return mujoco_impact.run(scene, duration=0.6, keyframe="shot")


def still(path: Path) -> np.ndarray:
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


def film(path: Path, size: tuple[int, int]) -> np.ndarray:
    """All pictures of a video of that width and height, shape (n, height, width, 3)."""
    if path.suffix == ".mp4":
        # imageio leaves the pipes of its reader open
        decoder = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", str(path)]
        decoder += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
        pixels = subprocess.run(decoder, check=True, capture_output=True).stdout
        return np.frombuffer(pixels, np.uint8).reshape(-1, *size[::-1], 3)
    pictures = []
    with Image.open(path) as animation:
        for number in range(animation.n_frames):
            animation.seek(number)
            pictures.append(np.asarray(animation.convert("RGB")))
            # 25 a second, so that it lasts as long as it says
            assert animation.info["duration"] == 40
    return np.array(pictures)


def command(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["video", *arguments], prog_name="mujoco-impact")


def blue(picture: np.ndarray) -> np.ndarray:
    """Where the ball is: bluer than anything else."""
    return (picture[..., 2] > 120) & (picture[..., :2].max(axis=-1) < 100)


@pytest.mark.usefixtures("gl")
@pytest.mark.parametrize("ending", ["mp4", "gif", "webp"])
def test_a_video_shows_the_motion(
    scene: mujoco.MjSpec, motion: Trajectory, ending: str, tmp_path: Path
) -> None:
    """0.6 s at half speed and 25 pictures a second: 31 pictures; the ball moves."""
    path = motion.render(
        scene, tmp_path / f"ball.{ending}", size=(160, 120), speed=0.5, arrows=False
    )
    pictures = film(path, (160, 142))
    assert len(pictures) == 31
    across = [np.nonzero(blue(one.astype(int)))[1].mean() for one in pictures]
    # 0.4 m on the way there, of 0.83 m that 120 pixels show at a distance of 1 m
    assert across[20] - across[0] == pytest.approx(58, abs=4)
    assert across[30] < across[22]


@pytest.mark.usefixtures("gl")
def test_points_are_where_the_picture_shows_them(
    scene: mujoco.MjSpec, motion: Trajectory, tmp_path: Path
) -> None:
    """The projection finds the ball, from a camera of the model and from a made one."""
    model = scene.compile()
    data = mujoco.MjData(model)
    panel = video.Panel.of(motion, "")
    for name in ("front", None):
        if name is None:
            model.cam_mode[:] = mujoco.mjtCamLight.mjCAMLIGHT_TRACK
        path = motion.render(
            model, tmp_path / "ball.png", at=0.1, size=(400, 300), camera=name
        )
        camera = camera_of(model, data, panel, name, 400 / 300)
        data.qpos[:] = panel.at(model, 0.1)
        mujoco.mj_forward(model, data)
        drawn = mujoco.MjvScene(model, 100)
        mujoco.mjv_updateScene(
            model, data, mujoco.MjvOption(), None, camera, 7, drawn
        )  # fmt: skip
        found = np.argwhere(blue(still(path))).mean(axis=0)[::-1]
        expected = Projection(drawn, 400, 300)(data.geom_xpos[1])
        # shading moves the middle of what is blue by a part of the radius
        assert found == pytest.approx(expected, abs=4), name


@pytest.mark.usefixtures("gl")
def test_impulses_are_arrows_on_the_body_that_moves(
    scene: mujoco.MjSpec, motion: Trajectory, tmp_path: Path
) -> None:
    """After the impact an arrow points away from the wall; before there is none."""
    (impact,) = motion.impacts

    def red(at: float, **options: bool) -> np.ndarray:
        path = motion.render(scene, tmp_path / "one.png", at=at, **options)
        return np.argwhere(np.abs(still(path) - ARROW).max(axis=-1) < 12)

    after = red(impact.time + 1e-3)
    assert len(after) > 100
    assert len(red(impact.time - 1e-3)) == 0
    assert len(red(impact.time + 1e-3, arrows=False)) == 0
    # the head, its widest part, is on the left: the wall pushes the ball that way
    columns = np.unique(after[:, 1], return_counts=True)
    widest = columns[0][columns[1].argmax()]
    assert widest < after[:, 1].mean()


@pytest.mark.usefixtures("gl")
def test_the_default_png_is_the_first_impact(
    scene: mujoco.MjSpec, motion: Trajectory, tmp_path: Path
) -> None:
    default = motion.render(scene, tmp_path / "default.png")
    there = motion.render(scene, tmp_path / "there.png", at=motion.impacts[0].time)
    assert (still(default) == still(there)).all()


@pytest.mark.usefixtures("gl")
def test_a_motion_that_starts_late_is_shown_from_its_start(
    scene: mujoco.MjSpec, tmp_path: Path
) -> None:
    """A keyframe has a time, which is that of the first picture."""
    scene = scene.copy()
    scene.add_key(name="late", time=5.0, qpos=scene.compile().qpos0)
    late = mujoco_impact.run(scene, duration=0.2, keyframe="late")
    path = late.render(scene, tmp_path / "late.webp", fps=10, keyframe="late")
    with Image.open(path) as film:
        assert film.n_frames == 3
    with pytest.raises(ConfigError, match=r"a time of the motion, 5 to 5\.2 s"):
        late.render(scene, tmp_path / "late.png", at=0.1, keyframe="late")


def test_rotations_between_samples_are_rotations() -> None:
    """Half-way between two quaternions of a quarter turn lies an eighth."""
    model = mujoco.MjModel.from_xml_string(BALL_AND_WALL)
    turned = [0, 0, 0, np.sqrt(0.5), np.sqrt(0.5), 0, 0]
    qpos = np.array([[0, 0, 0, 1, 0, 0, 0], turned])
    panel = video.Panel("", np.array([0.0, 1.0]), qpos)
    eighth = [np.cos(np.pi / 8), np.sin(np.pi / 8), 0, 0]
    assert panel.at(model, 0.5)[3:] == pytest.approx(eighth, abs=1e-12)
    assert (panel.at(model, 2.0) == turned).all()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"speed": 0.0}, "speed = 0.0: must be a finite number > 0"),
        ({"size": (8, 100)}, "width and height must be 16 to 4096"),
        ({"fps": 0}, "fps = 0: must be 1 to 120"),
        ({"speed": 1e-6}, "allowed: 20000"),
        ({"camera": "fron"}, "did you mean 'front'?"),
        ({"at": 0.1}, "at = 0.1: only a .png is of one time"),
    ],
)
@pytest.mark.usefixtures("gl")
def test_a_view_that_cannot_be_is_named(
    scene: mujoco.MjSpec, motion: Trajectory, options: dict, says: str, tmp_path: Path
) -> None:
    with pytest.raises((ConfigError, SceneError), match=says):
        motion.render(scene, tmp_path / "x.gif", **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("gl")
def test_another_model_is_refused(motion: Trajectory, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="7 positions, the model 0"):
        motion.render("<mujoco/>", tmp_path / "x.png")


def test_an_unknown_ending_is_refused(motion: Trajectory, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"must end in \.mp4, \.gif, \.webp"):
        motion.render(BALL_AND_WALL, tmp_path / "x.avi")


def test_without_the_encoder_the_remedy_is_told(
    motion: Trajectory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtraError, match=r"imageio_ffmpeg: run .*\[video\]"):
        motion.render(BALL_AND_WALL, tmp_path / "x.mp4")


def test_what_mujoco_cannot_integrate_is_shown_up_to_there() -> None:
    """A contact with far too much damping for the timestep; the caption says when."""
    contact = 'solref="-1e6 -1e12" solimp=".9999 .9999 .001"'
    defaults = f"<default><geom {contact}/></default><worldbody>"
    stiff = BALL_AND_WALL.replace("<worldbody>", defaults)
    spec = mujoco_impact.attach(stiff)
    panel = native_panel(spec, 0.6, {"keyframe": "shot"})
    assert panel.time[-1] < 0.6
    assert "fail at 0.4" in panel.caption
    assert np.isfinite(panel.qpos).all()


class TestOpenGL:
    """Which way to render is taken, and what is said if there is none."""

    @pytest.fixture(autouse=True)
    def _free_choice(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delenv("MUJOCO_GL", raising=False)
        monkeypatch.delenv("PYOPENGL_PLATFORM", raising=False)
        opengl._headless.cache_clear()
        yield
        opengl._headless.cache_clear()

    @pytest.fixture
    def broken(self, monkeypatch: pytest.MonkeyPatch) -> set[str]:
        """Ways to render that do not work."""
        names: set[str] = set()
        monkeypatch.setattr(
            opengl, "_failure", lambda name: "no driver" if name in names else ""
        )
        return names

    @pytest.mark.usefixtures("broken")
    def test_egl_comes_first(self) -> None:
        assert opengl.backend_name() == "egl"

    def test_osmesa_is_the_fallback(self, broken: set[str]) -> None:
        broken.add("egl")
        assert opengl.backend_name() == "osmesa"

    def test_neither_is_said_with_a_remedy(self, broken: set[str]) -> None:
        broken.update(("egl", "osmesa"))
        with pytest.raises(RenderingError, match="neither EGL nor OSMesa") as error:
            opengl.backend_name()
        assert "egl: no driver; osmesa: no driver" in str(error.value)
        assert "apt install" in str(error.value)

    def test_the_variable_decides(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("MUJOCO_GL", "osmesa")
        assert opengl.backend_name() == "osmesa"
        monkeypatch.setenv("MUJOCO_GL", "disable")
        with pytest.raises(RenderingError, match="MUJOCO_GL=disable"):
            opengl.backend_name()

    def test_a_trial_that_fails_says_why(self) -> None:
        """The trial is real: a way that does not exist does not work."""
        assert "No module named" in opengl._failure("no_such_way")


@pytest.mark.usefixtures("gl")
def test_osmesa_draws_the_same(tmp_path: Path) -> None:
    """In a process of its own: PyOpenGL is bound to one way for good."""
    (tmp_path / "scene.xml").write_text(BALL_AND_WALL)
    words = [sys.executable, "-m", "mujoco_impact", "video", "scene.xml"]
    words += ["--keyframe", "shot", "--duration", "0.6", "--out"]
    pictures = []
    for way in ("osmesa", "egl"):
        if opengl._failure(way):
            pytest.skip(f"{way} does not work here (Debian: libosmesa6, libegl1)")
        environment = {**os.environ, "MUJOCO_GL": way, "PYOPENGL_PLATFORM": ""}
        out = tmp_path / f"{way}.png"
        subprocess.run([*words, out.name], cwd=tmp_path, env=environment, check=True)
        pictures.append(still(out))
    # two rasterizers differ along edges
    assert np.abs(pictures[0] - pictures[1]).mean() < 2


@pytest.mark.usefixtures("gl")
def test_the_command_compares(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo, ours and the reference; ours looks as the reference does."""
    monkeypatch.chdir(tmp_path)
    result = command(
        *("row_3", "--compare", "--duration", "0.5", "--size", "120x90"),
        *("--no-arrows", "--at", "0.5", "--out", "three.png"),
    )
    assert result.exit_code == 0, result.output
    assert "Hertz reference" in result.output
    assert "picture: three.png" in result.output
    picture = still(tmp_path / "three.png")
    assert picture.shape[1] == 3 * 120 + 2 * 4
    mujocos, ours, truth = (picture[22:112, x : x + 120] for x in (0, 124, 248))
    # half a pixel of an edge at most, where MuJoCo's balls are elsewhere
    assert (np.abs(ours - truth).max(axis=-1) > 60).sum() < 10
    assert (np.abs(mujocos - truth).max(axis=-1) > 60).sum() > 50


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--size", "12"], "--size '12': must be WxH"),
        (["--out", "x.avi"], "must end in"),
        (["--out", "x.png", "--at", "0.2"], "a time of the motion, 0 to 0.1 s"),
        (["--out", "x.png", "--at", "-1"], "a time of the motion, 0 to 0.1 s"),
        (["--out", "x.png", "--at", "nan"], "a time of the motion, 0 to 0.1 s"),
        (["--at", "0.1"], "only a .png is of one time"),
        (["--camera", "x"], "there is no camera 'x'"),
        (["--geoms", "x"], "there is no geom 'x'"),
        (["--closing-speed", "0"], "--closing-speed 0.0: must be a speed > 0 [m/s]"),
    ],
)
@pytest.mark.usefixtures("gl")
def test_the_command_errs_in_one_sentence(
    arguments: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = command("row_3", "--duration", "0.1", *arguments)
    assert result.exit_code == 2
    assert says in result.stderr
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
