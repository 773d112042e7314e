"""A wheel built from these sources, installed where nothing else of the project is."""

import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes more than ten seconds")


@dataclass(frozen=True)
class Installed:
    """A virtual environment with the wheel in it."""

    folder: Path
    wheel: Path

    @property
    def package(self) -> Path:
        (site,) = self.folder.glob("lib/python*/site-packages")
        return site / "mujoco_impact"

    def command(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Runs a program of the environment, outside the source tree."""
        program, *rest = arguments
        return subprocess.run(
            [self.folder / "bin" / program, *rest],
            cwd=self.folder,
            env={"PATH": "/usr/bin:/bin", "MUJOCO_GL": "disable"},
            check=False,
            capture_output=True,
            text=True,
        )

    def python(self, code: str) -> subprocess.CompletedProcess[str]:
        """Runs Python code in which warnings are errors."""
        return self.command("python", "-W", "error", "-c", code)


def pip(*arguments: object) -> None:
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-q"]
    result = subprocess.run(
        [*command, *map(str, arguments)], check=False, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stderr


@pytest.fixture(scope="session")
def installed(tmp_path_factory) -> Installed:
    folder = tmp_path_factory.mktemp("wheel")
    build = folder / "build"
    pip(
        "wheel", ROOT, "--no-deps", "--no-build-isolation", "-w", folder,
        "-C", f"build-dir={build}",
    )  # fmt: skip
    (wheel,) = folder.glob("*.whl")
    home = folder / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", home], check=True)
    (site,) = home.glob("lib/python*/site-packages")
    # the dependencies come from here, by their path alone: an editable install of this
    # project hooks in by a .pth file, and those of an added path are not read
    places = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    (site / "dependencies.pth").write_text("\n".join(sorted(places)) + "\n")
    pip("--python", home / "bin" / "python", "install", "--no-deps",
        "--ignore-installed", "--no-index", wheel)  # fmt: skip
    return Installed(home, wheel)
