"""Files and numbers made to use up memory or to upset the reader: one sentence each."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from test_files import attempt
from typer.testing import CliRunner, Result

import mujoco_impact
from mujoco_impact import Trajectory, attach, calibration, run
from mujoco_impact.calibration.parameters import FORMAT
from mujoco_impact.cli import app
from mujoco_impact.errors import (
    ConfigError,
    ImpactError,
    SceneError,
    ShotsError,
    TrajectoryError,
)
from mujoco_impact.files import write_text

resource = pytest.importorskip("resource", reason="limits of memory are of Unix")

MEMORY = 2 << 30
"""More than any of these tests has a use for, on top of what is in use [bytes]."""


@pytest.fixture(autouse=True)
def _little_memory():
    """A test that asks for more memory fails at once, instead of taking it all."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


def command(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments), prog_name="mujoco-impact")


def is_refused(result: Result, *words: str) -> None:
    """One sentence on standard error, exit code 2, and nothing written."""
    assert result.exit_code == 2, result.output
    assert isinstance(result.exception, SystemExit)
    assert result.stderr.startswith("mujoco-impact: ")
    assert result.stderr.count("\n") == 1
    for word in words:
        assert word in result.stderr


def files() -> list[str]:
    """Returns what is in the folder."""
    return sorted(path.name for path in Path().iterdir())


SHOTS = {
    "claims ten million balls": (b"shot,m9999999 [kg]\n1,1\n", "2 to 100 balls"),
    "skips to ten million": (b"m1 [kg],m2 [kg],m9999999 [kg]\n1,1,1", "'m3 [kg]' is"),
    "a number of 5000 digits": (b"m1 [kg],m" + b"9" * 5000 + b" [kg]\n1", "missing"),
    "a million columns": (
        ",".join(f"m{i} [kg]" for i in range(1, 1_000_001)).encode(),
        "1000000 columns",
    ),
    "a million empty columns": (b"," * 1_000_000, "is empty"),
    "the same column twice": (
        b"m1 [kg],m2 [kg],m1 [kg]",
        "column 3: 'm1 [kg]' is twice",
    ),
    "200 balls": (
        ",".join(f"m{i} [kg]" for i in range(1, 201)).encode(),
        "2 to 100 balls are needed; found 'm1 [kg]', 'm2 [kg]'",
    ),
    "a cell without end": (b"m1 [kg],m2 [kg]\n" + b"9" * 200_000, "field limit"),
    "a quote without end": (b'"m1 [kg],m2 [kg]\n', "unexpected end"),
    "Latin-1": ("m1 [kg],m2 [kg],Kugel ä".encode("latin-1"), "byte 0xe4 in line 1"),
    "UTF-16": ("m1 [kg],m2 [kg]".encode("utf-16"), "not UTF-8: byte 0xff"),
    "zeros": (b"\0" * 1000, "column 1: '"),
    "nothing": (b"", "is empty"),
    "a line break": (b"\n", "is empty"),
}


@pytest.mark.parametrize("case", SHOTS)
def test_shots_that_attack_are_refused(case):
    content, words = SHOTS[case]
    path = Path("shots.csv")
    path.write_bytes(content)
    with pytest.raises(ShotsError) as caught:
        calibration.read_shots(path)
    assert words in str(caught.value)
    assert "shots.csv" in str(caught.value)
    assert len(str(caught.value)) < 500
    is_refused(command("calibrate", "shots.csv"), words)
    assert files() == ["shots.csv"]


def parameters(sh: str = "190", more: str = "", head: str = "") -> str:
    """Returns a file of parameters with some text in the place of a number."""
    return (
        f'{{"format": "{FORMAT}",{head} "parameters": {{"alpha": [1, 0.9], "sh": {sh}, '
        f'"sw": 0.4, "w0": 0.0075, "kappa": 0.083, "e": 0.9, "mu_s": 0, "mu_d": 0'
        f"{more}}}}}"
    )


PARAMETERS = {
    "400 digits": (parameters("9" * 400), "sh = inf"),
    "10,000 digits": (parameters("9" * 10_000), "sh = inf"),
    "100,000 nested lists": (parameters("[" * 100_000 + "]" * 100_000), "recursion"),
    "100,000 open lists": ("[" * 100_000, "recursion"),
    "100,000 open objects": ('{"a":' * 100_000, "recursion"),
    "a parameter twice": (parameters(more=', "sh": 2'), "'sh' is there twice"),
    "a key twice": (parameters(head=f'"format": "{FORMAT}",'), "'format' is there"),
    "not a number": (parameters("NaN"), "sh = nan"),
    "infinity": (parameters("-Infinity"), "sh = -inf"),
    "an exponent": (parameters("1e999"), "sh = inf"),
    "a flag": (parameters("true"), "sh = True"),
    "a text without end": (parameters(f'"{"x" * 10**6}"'), "sh = 'xxx"),
    "half a letter": (parameters('"\\ud800"'), "sh = '\\ud800'"),
    "nothing": ("", "Expecting value"),
    "null": ("null", "not a file of parameters"),
}


@pytest.mark.parametrize("case", PARAMETERS)
def test_parameters_that_attack_are_refused(case):
    content, words = PARAMETERS[case]
    Path("p.json").write_text(content)
    with pytest.raises(ConfigError) as caught:
        calibration.read_parameters("p.json")
    assert words in str(caught.value)
    assert "p.json" in str(caught.value)
    assert len(str(caught.value)) < 300
    is_refused(command("run", "row_3", "--params", "p.json"), words)


def test_parameters_keep_their_values():
    """Integers are as good as numbers with a point, and a byte order mark is none."""
    Path("p.json").write_text(parameters(), encoding="utf-8-sig")
    found = calibration.read_parameters("p.json")
    assert found.alpha == (1.0, 0.9)
    assert found.sh == 190.0
    assert type(found.sh) is float


@pytest.mark.parametrize("path", ["/dev/zero", ".", "no/such", "a\0b", "x" * 300])
def test_what_is_not_a_file_is_refused(path):
    for read in (calibration.read_shots, calibration.read_parameters):
        with pytest.raises(ImpactError, match="cannot read"):
            read(path)
    for use in (Trajectory.load, attach):
        attempt(lambda use=use: use(path))
        with pytest.raises(ImpactError):
            use(path)


@pytest.fixture(scope="module")
def motion() -> Trajectory:
    return run(attach(BALLS), duration=0.2, keyframe="shot")


BALLS = """<mujoco model="balls"><option gravity="0 0 0"/>
  <default><geom size=".015"/><joint type="slide" axis="1 0 0"/></default>
  <worldbody>
    <body pos="-.05 0 0"><joint/><geom name="left"/></body>
    <body><joint/><geom name="right"/></body>
  </worldbody>
  <keyframe><key name="shot" qvel=".5 0"/></keyframe></mujoco>"""


def with_array(motion: Trajectory, name: str, content: bytes) -> Path:
    """Returns a trajectory file in which one array is replaced."""
    good, bad = motion.save("good.npz"), Path("bad.npz")
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(bad, "w") as target:
        for member in source.namelist():
            told = content if member == f"{name}.npy" else source.read(member)
            target.writestr(member, told)
    return bad


def array_file(array: object) -> bytes:
    """Returns an array as a file."""
    file = io.BytesIO()
    np.save(file, np.asarray(array))
    return file.getvalue()


def claiming(shape: str, kind: str = "<f8") -> bytes:
    """Returns the header of an array without the array."""
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


ARRAYS = {
    "1e12 times": ("time", claiming("(1000000000000,)"), "is not there"),
    "a negative shape": ("time", claiming("(-1,)"), "is not there"),
    "texts of no length": ("impact_geoms", claiming("(10**12, 2)", "<U0"), ""),
    "a nested header": ("time", claiming("(" * 5000), ""),
    "objects": ("time", claiming("(1,)", "|O"), "is not there"),
    "no samples": ("time", array_file(np.zeros(0)), "0 samples"),
    "fewer times": ("time", array_file(np.zeros(3)), "'qpos' has shape (101, 2)"),
    "flat positions": (
        "qpos",
        array_file(np.zeros(101)),
        "needed: (101, n) of numbers",
    ),
    "three energies": ("energy", array_file(np.zeros((101, 3))), "needed: (101, 2)"),
    "text positions": ("qpos", array_file(np.full((101, 2), "x")), "of numbers"),
    "complex positions": ("qpos", array_file(np.zeros((101, 2)) * 1j), "of numbers"),
    "impacts of two numbers": (
        "impact_numbers",
        array_file(np.zeros((1, 2))),
        "(1, 17)",
    ),
    "an impact number": ("impact_numbers", array_file(1.0), "impact_numbers"),
    "geoms of nobody": ("impact_geoms", array_file(np.full((9, 2), "x")), "(1, 2)"),
    "a list of timesteps": (
        "timestep",
        array_file([1.0, 2.0]),
        "needed: () of numbers",
    ),
    "a number as integrator": ("integrator", array_file(1.0), "needed: () of text"),
    "a version that is text": ("layout_version", array_file("1"), "layout version"),
    "half a missed impact": ("missed_impacts", array_file(0.5), "of integers"),
}


@pytest.mark.parametrize("case", ARRAYS)
def test_trajectories_that_attack_are_refused(motion, case):
    name, content, words = ARRAYS[case]
    path = with_array(motion, name, content)
    with pytest.raises(TrajectoryError, match=r"bad\.npz") as caught:
        Trajectory.load(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_trajectory_with_an_array_twice_is_refused(motion):
    path = motion.save("twice.npz")
    with zipfile.ZipFile(path, "a") as archive, pytest.warns(UserWarning, match="Dup"):
        archive.writestr("time.npy", array_file(motion.time + 1))
    with pytest.raises(TrajectoryError, match=r"'time.npy' twice"):
        Trajectory.load(path)


def test_a_trajectory_larger_than_any_run_is_refused(motion, monkeypatch):
    """Zeros take a thousandth of their size in a compressed file."""
    monkeypatch.setattr("mujoco_impact.recordings.LARGEST_RECORDING", 10_000)
    path = with_array(motion, "qpos", array_file(np.zeros((101, 1000))))
    with pytest.raises(TrajectoryError, match=r"its arrays have 8\.\d+e\+05 bytes"):
        Trajectory.load(path)


MODELS = {
    "Latin-1": (BALLS.replace("left", "läft").encode("latin-1"), "byte 0xe4 in line 4"),
    "UTF-16": (BALLS.encode("utf-16"), "not UTF-8: byte 0xff in line 1"),
    "an include in Latin-1": (
        b'<mujoco><include file="part.xml"/></mujoco>',
        "part.xml: it is not UTF-8: byte 0xe4",
    ),
    "an include of itself": (
        b'<mujoco><include file="model.xml"/></mujoco>',
        "already included",
    ),
    "100,000 nested bodies": (
        b"<mujoco><worldbody>" + b"<body>" * 100_000,
        "nesting is too deep",
    ),
}


@pytest.mark.parametrize("case", MODELS)
def test_models_that_attack_are_refused(case):
    content, words = MODELS[case]
    Path("model.xml").write_bytes(content)
    Path("part.xml").write_bytes("<mujoco model='ä'/>".encode("latin-1"))
    with pytest.raises(SceneError) as caught:
        attach("model.xml")
    assert words in str(caught.value)
    for verb in ("run", "compare", "stress"):
        is_refused(command(verb, "model.xml"), words)


def test_names_cannot_command_the_terminal():
    """They are shown escaped, in tables, lines and errors alike."""
    evil = BALLS.replace('"left"', '"l&#27;[31m&#7;eft"').replace(
        'model="balls"', 'model="b&#27;]0;title&#7;&#x9b;2J&#x202e;"'
    )
    Path("evil.xml").write_text(evil)
    run_it = ("run", "evil.xml", "--duration", "0.2")
    shown = command(*run_it, "--keyframe", "shot")
    assert shown.exit_code == 0, shown.output
    assert r"l\x1b[31m\x07eft - right" in shown.stdout
    assert r"b\x1b]0;title\x07\x9b2J\u202e, from keyframe 'shot': 0.2 s" in shown.stdout
    error = command(*run_it, "--keyframe", "\x1b[2J")
    is_refused(error, r"\x1b[2J")
    stress = command("stress", "evil.xml", "--duration", "0.01")
    compare = command(
        *("compare", "evil.xml", "--keyframe", "shot", "--duration", "0.2"),
        *("--json", "-"),
    )
    for result in (shown, error, stress, compare):
        for letter in "\x1b\x07\x9b\u202e":
            assert letter not in result.output
    assert json.loads(compare.stdout)["scene"].startswith("b\x1b]0;title")


def test_names_are_no_formulas_in_pictures():
    """matplotlib takes text between dollars for a formula, and fails if it is none."""
    Path("dollar.xml").write_text(
        BALLS.replace('"balls"', r'"$\bad$"').replace('"left"', r'"$x_$"')
    )
    result = command(
        *("compare", "dollar.xml", "--keyframe", "shot", "--duration", "0.2"),
        *("--png", "picture"),
    )
    assert result.exit_code == 0, result.output
    assert Path("picture").read_bytes().startswith(b"\x89PNG")


NUMBERS = {
    "run for 30 years": (("run", "row_3", "--duration", "1e9"), "allowed: 4e+09"),
    "run for ever": (("run", "row_3", "--duration", "1e308"), "more than 2^53 steps"),
    "run for nan": (("run", "row_3", "--duration", "nan"), "duration = nan"),
    "compare for 30 years": (("compare", "row_3", "--duration", "1e9"), "4e+09"),
    "stress for 30 years": (("stress", "row_3", "--duration", "1e9"), "4e+09"),
    "every 10**30 steps": (("run", "row_3", "--every", f"1{'0' * 30}"), "1 to 1500"),
    "every 0 steps": (("run", "row_3", "--every", "0"), "every = 0"),
    "keyframe 10**30": (("run", "row_3", "--keyframe", f"1{'0' * 30}"), "no keyframe"),
    "10**12 shots": (("shots", "AAA", "--count", f"1{'0' * 12}"), "count 1 to 10000"),
    "10,000 balls": (("shots", "A" * 10_000), "10000 balls; allowed: 2 to 100"),
    "endless speed": (("shots", "AAA", "--fastest", "inf"), "slowest <= fastest"),
    "a camera that sees nothing": (("shots", "AAA", "--error", "1e300"), "error 0 to"),
    "a setting that is none": (("run", "row_3", "--set", "source=x"), "unknown"),
    "geoms as a setting": (("compare", "row_3", "--set", "geoms=x"), "unknown"),
    "no file to write": (
        ("run", "row_3", "--duration", ".01", "--out", "/"),
        "Is a directory",
    ),
    "a folder to write": (("shots", "AAA", "--out", "."), "Is a directory"),
    "a folder as picture": (
        ("compare", "row_3", "--duration", "0.3", "--png", "."),
        "Is a directory",
    ),
}


@pytest.mark.parametrize("case", NUMBERS)
def test_numbers_that_attack_are_refused(case):
    arguments, words = NUMBERS[case]
    is_refused(command(*arguments), words)
    assert files() == []


def test_numbers_out_of_range_name_their_option():
    result = command("shots", "AAA", "--seed", "-1")
    assert result.exit_code == 2
    assert "--seed" in result.stderr


def test_rollouts_larger_than_memory_are_refused():
    model = attach(BALLS).compile()
    for count, every in ((1, 1), (1000, 10_000)):
        with pytest.raises(ValueError, match=r"allowed: 4e\+09"):
            mujoco_impact.rollout(
                model,
                duration=1e9 if count == 1 else 1e6,
                qvel=np.zeros((count, model.nv)),
                every=every,
                threads=1,
            )


def test_a_file_that_cannot_be_written_whole_stays_as_it_was(motion, monkeypatch):
    path = motion.save("motion.npz")
    before = path.read_bytes()

    def full(file, *_, **__):
        Path(file).write_bytes(b"PK half of it")
        raise OSError(28, "No space left on device", str(file))

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(TrajectoryError, match=r"motion.npz: No space left"):
        motion.save("motion.npz")
    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(OSError, match=r"No space left on device: 'motion\.npz'"):
        write_text("motion.npz", "half")
    assert path.read_bytes() == before
    assert files() == ["motion.npz"]


def test_a_file_is_replaced_where_it_lies(tmp_path):
    """Through a link, with its permissions; a device is written itself."""
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    real.chmod(0o640)
    link.symlink_to(real)
    write_text(link, "new")
    assert link.is_symlink()
    assert real.read_text() == "new"
    assert real.stat().st_mode & 0o777 == 0o640
    write_text("/dev/null", "nothing")
    assert Path("/dev/null").is_char_device()
    with pytest.raises(FileNotFoundError, match=r"no/such\.txt"):
        write_text("no/such.txt", "")
    with pytest.raises(NotADirectoryError, match=r"real\.txt/such\.txt"):
        write_text(real / "such.txt", "")
    assert files() == ["link.txt", "real.txt"]
