"""Registering the plugin, and saying why it cannot be registered."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

from mujoco_impact import _plugin, load
from mujoco_impact.errors import ImpactWarning, PluginError


def python(code: str) -> subprocess.CompletedProcess[str]:
    """Runs code in a fresh interpreter in which warnings are errors."""
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        check=False,
        capture_output=True,
        text=True,
    )


def test_loading_again_does_nothing() -> None:
    """The plugin stays registered once."""
    load()
    load()
    assert _plugin.is_registered()


@pytest.mark.parametrize(
    "code",
    [
        "import mujoco, mujoco_impact",
        "import mujoco_impact, mujoco",
        "import mujoco_impact",
        "from mujoco_impact import _plugin; _plugin.load()",
    ],
)
def test_works_in_any_order_of_imports(code: str) -> None:
    """Silently, and models that name the plugin compile."""
    use = (
        "; mujoco_impact = __import__('mujoco_impact'); mujoco_impact.load()"
        "; import mujoco; mujoco.MjModel.from_xml_string("
        '\'<mujoco><extension><plugin plugin="mujoco_impact.waveform"/>'
        "</extension></mujoco>')"
    )
    result = python(code + use)
    assert result.returncode == 0, result.stderr
    assert result.stdout == result.stderr == ""


def test_the_sensor_is_at_hand_without_an_import_of_its_own() -> None:
    """As the other parts are."""
    result = python("import mujoco_impact; print(mujoco_impact.sensor.read_sensor)")
    assert result.stdout.startswith("<function read_sensor"), result.stderr


def test_importing_the_package_is_light() -> None:
    """MuJoCo 4 imports it at every `import mujoco`."""
    heavy = ("matplotlib", "typer", "rich", "scipy", "dm_control")
    result = python(
        f"import sys, mujoco_impact; print([m for m in {heavy} if m in sys.modules])"
    )
    assert result.stdout.strip() == "[]", result.stderr


def test_missing_library_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the variable that points to it."""
    monkeypatch.setenv("MUJOCO_IMPACT_PLUGIN", str(tmp_path / "none.so"))
    with pytest.raises(PluginError, match=r"MUJOCO_IMPACT_PLUGIN=.*none.so: there is"):
        _plugin.plugin_path()


def test_library_not_built_says_how(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command that builds it."""
    monkeypatch.delenv("MUJOCO_IMPACT_PLUGIN", raising=False)
    monkeypatch.setattr(_plugin, "_library_name", lambda: "libnot_built.so")
    with pytest.raises(PluginError, match=r"does not exist: build it with `pip"):
        _plugin.plugin_path()


def test_import_without_a_library_warns_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that `mujoco-impact doctor` can say what to do."""
    monkeypatch.setenv("MUJOCO_IMPACT_PLUGIN", str(tmp_path / "none.so"))
    monkeypatch.setattr(_plugin, "is_registered", lambda: False)
    with pytest.warns(ImpactWarning, match="there is no such file"):
        _plugin.load_or_warn()


def test_file_that_is_no_library_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Instead of an error of the loader."""
    broken = tmp_path / "broken.so"
    broken.write_text("not a library")
    monkeypatch.setenv("MUJOCO_IMPACT_PLUGIN", str(broken))
    monkeypatch.setattr(_plugin, "is_registered", lambda: False)
    with pytest.raises(PluginError, match=r"cannot load the plugin .*broken.so"):
        load()


def test_another_mujoco_is_named_with_both_versions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """There is no stable binary interface between them."""
    monkeypatch.delenv("MUJOCO_IMPACT_PLUGIN", raising=False)
    monkeypatch.setattr(_plugin, "is_registered", lambda: False)
    monkeypatch.setattr(_plugin, "built_for", lambda: "1.2.3")
    monkeypatch.setattr(_plugin, "plugin_path", lambda: Path("library.so"))
    running = mujoco.mj_versionString()
    with pytest.raises(PluginError, match=rf"for MuJoCo 1\.2\.3, but MuJoCo {running}"):
        load()
