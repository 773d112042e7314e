"""A wheel, installed where nothing else of the project is.

It is built from these sources, or the one of `--wheel FILE`.
"""

import os
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# without it no program starts on Windows
SYSTEM = {key: os.environ[key] for key in ("SYSTEMROOT",) if key in os.environ}


def pytest_addoption(parser):
    parser.addoption("--wheel", help="wheel to test, instead of one built here")


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes more than ten seconds")


@dataclass(frozen=True)
class Installed:
    """A virtual environment with the wheel in it."""

    folder: Path
    wheel: Path

    @property
    def package(self) -> Path:
        return place("purelib", self.folder) / "mujoco_impact"

    def command(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Runs a program of the environment, outside the source tree."""
        program, *rest = arguments
        return subprocess.run(
            [place("scripts", self.folder) / program, *rest],
            cwd=self.folder,
            env={"PATH": os.defpath, "MUJOCO_GL": "disable", **SYSTEM},
            check=False,
            capture_output=True,
            text=True,
        )

    def python(self, code: str) -> subprocess.CompletedProcess[str]:
        """Runs Python code in which warnings are errors."""
        return self.command("python", "-W", "error", "-c", code)


def place(kind: str, environment: Path) -> Path:
    """A folder of a virtual environment: "purelib" or "scripts"."""
    return Path(sysconfig.get_path(kind, vars={"base": str(environment)}))


def pip(*arguments: object) -> None:
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-q"]
    result = subprocess.run(
        [*command, *map(str, arguments)], check=False, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stderr


def built(folder: Path) -> Path:
    """Builds a wheel from these sources."""
    pip(
        "wheel", ROOT, "--no-deps", "--no-build-isolation", "-w", folder,
        "-C", f"build-dir={folder / 'build'}",
    )  # fmt: skip
    (wheel,) = folder.glob("*.whl")
    return wheel


@pytest.fixture(scope="session")
def installed(tmp_path_factory, request) -> Installed:
    folder = tmp_path_factory.mktemp("wheel")
    # the option is not known where this folder was not named on the command line
    given = request.config.getoption("--wheel", default=None)
    wheel = Path(given).resolve() if given else built(folder)
    home = folder / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", home], check=True)
    # the dependencies come from here, by their path alone: an editable install of this
    # project hooks in by a .pth file, and those of an added path are not read
    places = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    (place("purelib", home) / "dependencies.pth").write_text(
        "\n".join(sorted(places)) + "\n"
    )
    pip("--python", place("scripts", home) / "python", "install", "--no-deps",
        "--ignore-installed", "--no-index", wheel)  # fmt: skip
    return Installed(home, wheel)
