"""What the documentation shows is what happens: every snippet is run."""

import contextlib
import io
import os
import re
import shlex
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mujoco_impact
from mujoco_impact import ImpactError, video
from mujoco_impact.cli import app

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted(
    str(page.relative_to(ROOT))
    for page in (
        *ROOT.glob("*.md"),
        *ROOT.glob("*/README.md"),
        *ROOT.glob("docs/**/*.md"),
    )
)
# optional libraries, and how code that needs one is known
OPTIONAL = {
    "dm_control": "dm_control|envs.load",
    "gymnasium": "gymnasium",
    "mujoco_warp": "mujoco_warp",
}
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")


@dataclass(frozen=True)
class Snippet:
    """A fenced block, and the text block that follows it as its expected output."""

    document: str
    language: str
    code: str
    output: str

    def __str__(self) -> str:
        return f"{self.document}: {self.code.strip().splitlines()[0]}"


def snippets(*languages: str) -> list[Snippet]:
    found = []
    for document in DOCUMENTS:
        text = (ROOT / document).read_text(encoding="utf-8")
        blocks = FENCE.findall(text)
        for (language, code), (following, output) in pairwise([*blocks, ("", "")]):
            expected = output if following == "text" else ""
            found.append(Snippet(document, language, code, expected))
    return [snippet for snippet in found if snippet.language in languages]


def words(text: str) -> list[str]:
    """The text without its spacing, which depends on the width of the terminal."""
    return text.split()


def test_there_are_snippets_of_every_kind():
    """The search finds what it should."""
    for language in ("python", "bash", "xml", "text"):
        assert [one for one in snippets(language) if one.document == "README.md"]


def test_the_first_two_commands_of_the_readme_are_there():
    """What they do is seen by whoever runs this: `scripts/test` is one of them."""
    first = next(one for one in snippets("bash") if one.document == "README.md")
    names = [line.split()[0] for line in first.code.splitlines()]
    assert names == ["scripts/demo", "scripts/test"]
    assert all(os.access(ROOT / name, os.X_OK) for name in names)


@pytest.mark.parametrize("snippet", snippets("python"), ids=str)
def test_python_runs_and_prints_what_it_says(snippet, tmp_path, monkeypatch):
    # as in a clone, whose files are not written
    monkeypatch.chdir(tmp_path)
    Path("docs").symlink_to(ROOT / "docs")
    for library, use in OPTIONAL.items():
        if re.search(use, snippet.code):
            pytest.importorskip(library)
    if "mujoco_warp" in snippet.code:
        import warp

        # it prints which kernels it compiles
        warp.config.log_level = warp.LOG_WARNING
    if ".render(" in snippet.code:
        need_rendering(monkeypatch)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(snippet.code, str(snippet), "exec"), {"__name__": "snippet"})
    if snippet.output:
        assert words(printed.getvalue()) == words(snippet.output)


def need_rendering(monkeypatch):
    """Switches rendering on, off for the tests; skips where nothing renders."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    try:
        video.check_rendering("scene.mp4")
    except ImpactError as error:
        pytest.skip(str(error))


def commands() -> list:
    return [
        pytest.param(line, snippet.output, id=line)
        for snippet in snippets("bash")
        for line in snippet.code.splitlines()
        if line.startswith("mujoco-impact")
    ]


@pytest.mark.parametrize(("line", "output"), commands())
def test_commands_succeed_and_print_what_they_say(line, output, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    if "--html" in line:
        pytest.importorskip("bokeh")
    if line.startswith("mujoco-impact view"):
        pytest.skip("it needs a display; tests/api/test_view.py has one")
    if line.startswith("mujoco-impact video"):
        need_rendering(monkeypatch)
    monkeypatch.chdir(tmp_path)
    Path("docs").symlink_to(ROOT / "docs")
    monkeypatch.setitem(os.environ, "COLUMNS", "100")
    result = CliRunner().invoke(app, shlex.split(line)[1:])
    assert result.exit_code == 0, result.output
    printed, expected = words(result.stdout), words(output)
    # what is shown may be the beginning of it: run times follow, which vary
    for shown, real in zip(expected, printed, strict=False):
        try:
            # MuJoCo versions differ in the last digit of its own contacts
            assert float(real) == pytest.approx(float(shown), abs=1.01e-4)
        except ValueError:
            assert real == shown
    assert len(printed) >= len(expected)


def touching_balls() -> list[Snippet]:
    """Every scene but those of the gallery, whose files its code runs."""
    return [one for one in snippets("xml") if one.document != "docs/gallery.md"]


@pytest.mark.parametrize("snippet", touching_balls(), ids=str)
def test_mjcf_gives_the_impact_of_touching_balls(snippet):
    """Ball 1 hits two that touch: -.0710, .0764, .9945 of its speed by Hertz."""
    motion = mujoco_impact.run(snippet.code, duration=0.2, keyframe="shot")
    assert len(motion.impacts) == 2
    expected = [-0.070952, 0.076403, 0.994549]
    left = motion.qvel[-1] / motion.qvel[0, 0]
    np.testing.assert_allclose(left, expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("snippet", touching_balls(), ids=str)
def test_mjcf_saved_to_a_file_runs_on_the_command_line(snippet, tmp_path, monkeypatch):
    """The same two impacts as from text."""
    monkeypatch.chdir(tmp_path)
    Path("scene.xml").write_text(snippet.code)
    result = CliRunner().invoke(
        app, ["run", "scene.xml", "--keyframe", "shot", "--duration", "0.2"]
    )
    assert result.exit_code == 0, result.output
    assert "impacts: 2" in result.output


@pytest.mark.parametrize("document", DOCUMENTS)
def test_links_lead_to_files_and_headings_that_exist(document):
    page = ROOT / document
    for target, anchor in LINK.findall(page.read_text(encoding="utf-8")):
        if target.startswith("http"):
            continue
        file = page.parent / target
        assert file.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", file.read_text(encoding="utf-8"), re.M)
            slugs = [re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-")
                     for h in headings]  # fmt: skip
            assert anchor[1:] in slugs, anchor


def test_the_attribute_table_has_every_attribute_and_no_other():
    text = (ROOT / "plugin/README.md").read_text(encoding="utf-8")
    table = text[text.index("## Attributes") : text.index("## Sensor")]
    rows = re.findall(r"^\| `(\w+)` \|", table, re.M)
    of_materials = ["materials", "material_pairs"]
    assert sorted(rows) == sorted([*mujoco_impact.settings.SETTINGS, *of_materials])


@pytest.mark.parametrize(
    ("attribute", "text"), [("young", "2e11"), ("w0", "7.5e-3"), ("touch", "1e-9")]
)
def test_the_defaults_of_the_table_are_those_of_the_plugin(attribute, text):
    """Setting the default changes no bit."""
    (scene,) = (s for s in snippets("xml") if s.document == "README.md")
    plain = mujoco_impact.run(scene.code, duration=0.2, keyframe="shot")
    instance = f'<instance name="impact"><config key="{attribute}" value="{text}"/>'
    explicit = mujoco_impact.run(
        scene.code.replace('<instance name="impact"/>', instance + "</instance>"),
        duration=0.2,
        keyframe="shot",
    )
    assert len(explicit.impacts) == 2
    np.testing.assert_array_equal(explicit.qvel, plain.qvel)
