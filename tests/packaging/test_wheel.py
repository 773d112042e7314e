"""What users install: a wheel that works away from the source tree."""

import re
import shutil
import struct
import sys
import zipfile
from pathlib import Path

import mujoco
import pytest

import cradle_models
from mujoco_impact import _plugin

pytestmark = pytest.mark.slow

RUNNING = mujoco.mj_versionString()
OURS = f"mujoco_impact/{_plugin._library_name()}"
LIBRARY = re.compile(r"\.(so|dylib|dll)\b")
DYNAMIC_SECTION, NEEDED, RPATH, RUNPATH = 6, 1, 15, 29


def dynamic_entries(library: Path) -> list[tuple[int, str]]:
    """The text entries of the dynamic section of a 64-bit ELF file, tag and text."""
    data = library.read_bytes()
    assert data[:5] == b"\x7fELF\x02", "not a 64-bit ELF file"
    table, size, count = (
        struct.unpack_from("<Q", data, 40)[0],
        *struct.unpack_from("<HH", data, 58),
    )
    # name, type, flags, address, offset, size, link, ...
    headers = [struct.unpack_from("<IIQQQQI", data, table + i * size)
               for i in range(count)]  # fmt: skip
    (dynamic,) = (header for header in headers if header[1] == DYNAMIC_SECTION)
    strings = headers[dynamic[6]][4]
    entries = struct.iter_unpack("<qQ", data[dynamic[4] : dynamic[4] + dynamic[5]])
    return [
        (tag, data[strings + at : data.index(b"\0", strings + at)].decode())
        for tag, at in entries
        if tag in (NEEDED, RPATH, RUNPATH)
    ]


def test_it_holds_the_library_the_models_and_the_entry_points(installed):
    with zipfile.ZipFile(installed.wheel) as wheel:
        names = set(wheel.namelist())
        (entry_points,) = (name for name in names if name.endswith("entry_points.txt"))
        text = wheel.read(entry_points).decode()
    # one library: what it needs of MuJoCo is the one that is installed
    assert {name for name in names if LIBRARY.search(name)} == {OURS}
    assert "mujoco_impact/_build.py" in names
    assert {f"cradle_models/{name}.xml" for name in cradle_models.list_models()} < names
    assert "[mujoco.plugins]\nmujoco_impact = mujoco_impact._plugin:load" in text
    assert "mujoco-impact = mujoco_impact.cli:main" in text
    # sources of the library, tests, and what only the project runs stay in the clone
    assert not [name for name in names if name.endswith((".cc", ".h"))]
    folders = {name.split("/")[0] for name in names}
    assert {one for one in folders if not one.endswith(".dist-info")} == {
        "mujoco_impact",
        "cradle_models",
    }


def test_extras_are_what_users_may_need(installed):
    """What the project needs for itself are groups, which a wheel does not name."""
    with zipfile.ZipFile(installed.wheel) as wheel:
        (file,) = (name for name in wheel.namelist() if name.endswith("/METADATA"))
        text = wheel.read(file).decode()
    assert set(re.findall(r"^Provides-Extra: (\S+)$", text, re.M)) == {
        "cluster",
        "plot",
        "report",
        "video",
        "dm-control",
        "gymnasium",
        "warp",
    }


def test_one_wheel_serves_every_python_of_a_platform(installed):
    """The library knows nothing of Python."""
    assert "-py3-none-" in installed.wheel.name


@pytest.mark.skipif(sys.platform != "linux", reason="reads ELF files")
def test_the_library_needs_this_mujoco_and_names_no_folder(installed):
    entries = dynamic_entries(installed.package / "libmujoco_impact.so")
    needed = [text for tag, text in entries if tag == NEEDED]
    paths = [text for tag, text in entries if tag in (RPATH, RUNPATH)]
    assert f"libmujoco.so.{RUNNING}" in needed
    # an absolute path could pull the MuJoCo of another environment in
    assert paths == ["$ORIGIN/../mujoco"]


def test_it_is_imported_from_the_wheel_without_a_word(installed):
    result = installed.python("import mujoco_impact; print(mujoco_impact.__file__)")
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert Path(result.stdout.strip()).parent == installed.package


def test_a_cradle_swings_away_from_the_source_tree(installed):
    code = (
        "import cradle_models, mujoco_impact; "
        "scene = mujoco_impact.attach(cradle_models.model_path('row_3')); "
        "motion = mujoco_impact.run(scene, duration=0.5, keyframe='release'); "
        "print(len(motion.impacts))"
    )
    result = installed.python(code)
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() == "2"


def test_the_command_is_there(installed):
    result = installed.command("mujoco-impact", "run", "row_3", "--duration", "0.5")
    assert result.returncode == 0, result.stderr
    assert "0.5 s simulated" in result.stdout


@pytest.fixture
def built_for_another(installed):
    """The environment as if its library had been built for another MuJoCo."""
    build = installed.package / "_build.py"
    original = build.read_text(encoding="utf-8")
    build.write_text(original.replace(RUNNING, "9.8.7"), encoding="utf-8")
    shutil.rmtree(build.parent / "__pycache__", ignore_errors=True)
    yield installed
    build.write_text(original, encoding="utf-8")
    shutil.rmtree(build.parent / "__pycache__", ignore_errors=True)


def test_another_mujoco_is_refused_in_one_sentence(built_for_another):
    result = built_for_another.command(
        "python", "-W", "ignore", "-c", "import mujoco_impact; mujoco_impact.load()"
    )
    assert result.returncode == 1
    last = result.stderr.strip().splitlines()[-1]
    assert "PluginError: mujoco-impact was built for MuJoCo 9.8.7" in last
    assert f"but MuJoCo {RUNNING} is installed" in last
    assert "pip install mujoco==9.8.7" in last


def test_another_mujoco_only_warns_at_import(built_for_another):
    """So that `mujoco-impact doctor` can run and explain."""
    result = built_for_another.command("python", "-c", "import mujoco_impact")
    assert result.returncode == 0
    assert "built for MuJoCo 9.8.7" in result.stderr
    result = built_for_another.command("mujoco-impact", "doctor")
    assert result.returncode != 0
    assert "9.8.7" in result.stdout + result.stderr
