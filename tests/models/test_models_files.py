"""The shipped model files: their names, and that they are what the functions make."""

import subprocess
import sys
from pathlib import Path

import pytest

import cradle_models


def test_the_catalogue_holds_the_rows_the_paper_the_toy_and_contacts() -> None:
    names = set(cradle_models.list_models())
    paper = {f"paper_{a}{b}{c}" for a in "ab" for b in "ab" for c in "ab"}
    others = {
        "row_3",
        "row_5",
        "row_10",
        "two_string_3",
        "two_string_5",
        "force_sensor",
    }
    contacts = {
        "billiards",
        "spinning_balls",
        "dominoes",
        "rocking_block",
        "cannon",
        "bernoulli_2",
        "bernoulli_4",
    }
    assert paper | others | contacts == names


@pytest.mark.parametrize("name", cradle_models.list_models())
def test_a_committed_file_equals_the_generated_model(name: str) -> None:
    path = cradle_models.model_path(name)
    assert path.read_text(encoding="utf-8") == cradle_models.make_model(name)


def test_no_model_file_lies_in_the_package_unlisted() -> None:
    folder = cradle_models.model_path("row_3").parent
    listed = {cradle_models.model_path(name) for name in cradle_models.list_models()}
    assert set(folder.glob("*.xml")) == listed


def test_one_command_writes_all_models(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "cradle_models", str(tmp_path)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    written = {path.stem for path in tmp_path.glob("*.xml")}
    assert written == set(cradle_models.list_models())
    assert {Path(line).stem for line in done.stdout.split("\n") if line} == written
    for name in written:
        text = (tmp_path / f"{name}.xml").read_text(encoding="utf-8")
        assert text == cradle_models.make_model(name)


@pytest.mark.parametrize("base", [cradle_models.CradleModelError, KeyError])
def test_an_unknown_name_lists_the_available_ones(base: type[Exception]) -> None:
    with pytest.raises(base) as caught:
        cradle_models.model_path("row_4")
    message = str(caught.value)
    assert "'row_4'" in message
    for name in cradle_models.list_models():
        assert name in message


def test_importing_the_models_imports_neither_mujoco_nor_the_plugin_package() -> None:
    code = (
        "import sys, cradle_models; cradle_models.row('AB'); "
        "sys.exit(any(m.split('.')[0] in ('mujoco', 'mujoco_impact', 'numpy') "
        "for m in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
