"""What is imported when: nothing heavy unless it is asked for."""

import subprocess
import sys

import pytest

from mujoco_impact.extras import install_hint

HEAVY = ("dm_control", "gymnasium", "shimmy", "matplotlib", "warp", "mujoco_warp")


def run(script):
    return subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )


def test_importing_the_package_imports_no_optional_library():
    found = run(
        f"import sys, mujoco_impact; print([n for n in {HEAVY} if n in sys.modules])"
    )
    assert found.stdout.strip() == "[]", found.stderr


def test_importing_the_environments_does_not_import_dm_control():
    found = run("import sys, mujoco_impact.envs; print('dm_control' in sys.modules)")
    assert found.stdout.strip() == "False", found.stderr


HIDDEN = """
import importlib.util, sys
find = importlib.util.find_spec
importlib.util.find_spec = lambda name, *a: None if name == "{0}" else find(name, *a)
import mujoco_impact
try:
    {1}
except mujoco_impact.ImpactError as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("library", "use"),
    [
        ("dm_control", "mujoco_impact.envs.load('cradle', 'strike')"),
        ("dm_control", "mujoco_impact.envs.Cradle()"),
        ("gymnasium", "mujoco_impact.envs.register_gymnasium()"),
        ("mujoco_warp", "mujoco_impact.warp.put_impacts"),
    ],
)
def test_a_missing_library_is_a_sentence_that_says_what_to_install(library, use):
    found = run(HIDDEN.format(library, use))
    extra = {"mujoco_warp": "warp"}.get(library, library)
    said = f"{library} is not installed: run {install_hint(extra)}"
    assert found.stdout.strip() == said, found.stderr


def test_a_dm_control_built_for_another_mujoco_is_a_sentence():
    pytest.importorskip("dm_control")
    found = run("""
import mujoco_impact
from dm_control.mujoco.wrapper.mjbindings import sizes
sizes.array_sizes["mjmodel"]["gone_field"] = (1,)
try:
    mujoco_impact.envs.load("cradle", "strike")
except mujoco_impact.ImpactError as error:
    print(error)
""")
    assert "built for another MuJoCo" in found.stdout, found.stderr
    assert "MjModel.gone_field" in found.stdout


def test_an_unknown_name_is_an_attribute_error():
    from mujoco_impact import envs

    with pytest.raises(AttributeError, match="no attribute 'Cradel'"):
        envs.Cradel  # noqa: B018


@pytest.mark.parametrize(
    "order",
    ["mujoco_impact, gymnasium", "gymnasium, mujoco_impact"],
)
def test_gymnasium_knows_the_environments_whichever_is_imported_first(order):
    pytest.importorskip("gymnasium")
    found = run(f"import {order}; print(*gymnasium.registry)")
    assert "mujoco_impact/CradleStrike-v0" in found.stdout, found.stderr
