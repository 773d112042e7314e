"""`doctor`: what is checked and what a failure looks like."""

from __future__ import annotations

import pytest

from mujoco_impact import _plugin, doctor
from mujoco_impact.errors import PluginError


def test_healthy_installation_passes_every_check() -> None:
    """Six checks, the last two with physics."""
    checks = doctor.diagnose()
    assert [check.passed for check in checks] == [True] * 6
    assert all(check.remedy == "" for check in checks)


def test_wrong_answer_of_the_plugin_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo's own contacts in place of ours."""
    monkeypatch.setattr(doctor, "attach", lambda xml, **_: xml)
    last = doctor.diagnose()[-1]
    assert (last.name, last.passed) == ("elastic impact", False)
    assert "after 0 impact(s)" in last.found
    assert last.remedy


def test_first_failure_ends_the_diagnosis(monkeypatch: pytest.MonkeyPatch) -> None:
    """The later checks need the earlier ones."""

    def refuse() -> None:
        msg = "no such plugin"
        raise PluginError(msg)

    monkeypatch.setattr(_plugin, "load", refuse)
    checks = doctor.diagnose()
    assert [check.passed for check in checks] == [True, True, True, False]
    assert checks[-1].found == "no such plugin"


def test_other_mujoco_version_gets_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    """The version to install."""
    monkeypatch.setattr(_plugin, "built_for", lambda: "1.2.3")
    last = doctor.diagnose()[-1]
    assert last.name == "MuJoCo version"
    assert last.remedy == "pip install mujoco==1.2.3"
