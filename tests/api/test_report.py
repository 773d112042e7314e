"""Reports: one page that a browser shows without a network, without an error."""

from __future__ import annotations

import importlib.util
import re
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from mujoco_impact.cli import app
from mujoco_impact.errors import RenderingError
from mujoco_impact.video import opengl

pytest.importorskip("bokeh")

DROP = """
<mujoco model="drop &lt;b&gt;">
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="ball" pos="0 0 .3"><freejoint/><geom name="ball" size=".05"/></body>
    <body name="box" pos=".5 0 .3"><freejoint/>
      <geom name="box" type="box" size=".05 .04 .03"/></body>
  </worldbody>
</mujoco>
"""


def command(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments), prog_name="mujoco-impact")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the report of each command."""
    folder = tmp_path_factory.mktemp("pages")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        Path("drop.xml").write_text(DROP)
        for words in (
            "run drop.xml --duration .6 --set restitution=.8 --html run.html",
            "compare row_3 --duration .5 --html compare.html",
            "compare drop.xml --duration .5 --html drop.html",
            "stress drop.xml --duration .3 --html stress.html",
            "shots AAB --count 8",
            "calibrate shots.csv --folds 0 --html calibrate.html",
        ):
            result = command(*words.split())
            assert result.exit_code == 0, result.output
    return folder


ALL = ("run", "compare", "drop", "stress", "calibrate")


@pytest.mark.parametrize("name", ALL)
def test_a_page_is_whole(pages: Path, name: str) -> None:
    """Nothing is fetched from elsewhere; command, versions and settings are told."""
    text = (pages / f"{name}.html").read_text(encoding="utf-8")
    assert len(text) < 1.6e6
    # the library has addresses in its text; what it fetches the browser tells below
    markup = re.sub(r"<script.*?</script>", "", text, flags=re.S)
    outside = re.findall(r'(?:src|href)="(?!data:)[^"]*"', markup)
    assert outside == []
    assert f"--html {name}.html</code>" in text
    for fact in ("MuJoCo", "NumPy", "mujoco-impact"):
        assert f"<dt>{fact}</dt>" in text


def test_the_run_page_holds_the_impacts(pages: Path) -> None:
    text = (pages / "run.html").read_text(encoding="utf-8")
    assert '<td class="text">floor - ball</td>' in text
    assert "<dd>restitution=.8</dd>" in text
    # the name of the scene is text, and no tag
    assert "<title>drop &lt;b&gt;: 0.6 s</title>" in text


def test_without_bokeh_the_remedy_is_told_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *rest: None if name == "bokeh" else find(name, *rest),
    )
    result = command("run", "row_3", "--html", "page.html")
    assert result.exit_code == 2
    assert "reports need bokeh: run `pip install" in result.stderr
    assert "[report]" in result.stderr


def test_a_video_without_a_report_is_refused() -> None:
    result = command("run", "row_3", "--video")
    assert result.exit_code == 2
    assert "--video: no effect without --html" in result.stderr


def test_a_page_that_cannot_be_written_is_told_first(tmp_path: Path) -> None:
    result = command("run", "row_3", "--html", str(tmp_path / "no" / "page.html"))
    assert result.exit_code == 2
    assert "page.html" in result.stderr
    assert "simulated" not in result.stdout


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A headless Chromium."""
    webdriver = pytest.importorskip("selenium.webdriver")
    binaries = [shutil.which(name) for name in ("chromium", "chromedriver")]
    if None in binaries:
        pytest.skip(
            "no Chromium with its driver (Debian: apt install chromium chromium-driver)"
        )
    options = webdriver.ChromeOptions()
    options.binary_location = binaries[0]
    folder = tmp_path_factory.mktemp("browser")
    for word in (
        "headless",
        "no-sandbox",
        "disable-gpu",
        "disable-quic",
        "no-first-run",
        "disable-background-networking",
        "disable-component-update",
        "disable-sync",
        "window-size=1200,900",
        f"user-data-dir={folder}",
    ):
        options.add_argument(f"--{word}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(executable_path=binaries[1])
    driver = webdriver.Chrome(options=options, service=service)
    yield driver
    driver.quit()


def opened(browser: Any, page: Path) -> list[float]:
    """Opens a page from disk; returns the heights of its plots, once they are drawn."""
    browser.get(page.as_uri())
    script = """
      return Bokeh.documents.length && Bokeh.documents.every(one => one.is_idle)
    """
    for _ in range(100):
        if browser.execute_script(script):
            break
        time.sleep(0.1)
    return browser.execute_script(
        """
        const heights = [];
        const walk = (view) => {
          if (view.model.type === 'Figure')
            heights.push(view.el.getBoundingClientRect().height);
          for (const child of view.child_views ?? []) walk(child);
        };
        for (const root of Bokeh.index.roots) walk(root);
        return heights;
        """
    )


@pytest.mark.parametrize(
    ("name", "plots"),
    [("run", 4), ("compare", 9), ("drop", 8), ("stress", 3), ("calibrate", 2)],
)
def test_a_browser_shows_the_plots_without_an_error(
    browser: Any, pages: Path, name: str, plots: int
) -> None:
    heights = opened(browser, pages / f"{name}.html")
    assert len(heights) == plots
    assert min(heights) > 100
    said = [one for one in browser.get_log("browser") if one["level"] != "INFO"]
    assert said == []
    # what is fetched from elsewhere would be a resource
    fetched = "return performance.getEntriesByType('resource').map(one => one.name)"
    assert [one for one in browser.execute_script(fetched) if "data:" not in one] == []


def test_a_pointer_on_a_curve_shows_its_values(browser: Any, pages: Path) -> None:
    """The tooltip of the first plot, over the first curve."""
    from selenium.webdriver.common.action_chains import ActionChains

    opened(browser, pages / "run.html")
    x, y = browser.execute_script(
        """
        const find = (view) => view.model.type === 'Figure' ? view :
          Array.from(view.child_views ?? []).map(find).find(one => one);
        const plot = Array.from(Bokeh.index.roots).map(find).find(one => one);
        plot.el.scrollIntoView();
        const data = plot.model.renderers[0].data_source.data;
        const frame = plot.frame, at = Math.floor(data.x.length / 4);
        const box = plot.canvas_view.el.getBoundingClientRect();
        return [box.x + frame.x_scale.compute(data.x[at]),
                box.y + frame.y_scale.compute(data.y[at])];
        """
    )
    chain = ActionChains(browser)
    chain.w3c_actions.pointer_action.move_to_location(int(x) - 3, int(y))
    chain.w3c_actions.pointer_action.move_to_location(int(x), int(y))
    chain.perform()
    time.sleep(0.5)
    shown = browser.execute_script(
        """
        const texts = [];
        const walk = (node) => {
          if (node.classList?.contains('bk-Tooltip')) texts.push(
            (node.shadowRoot ?? node).textContent);
          for (const root of [node, node.shadowRoot])
            for (const child of root?.children ?? []) walk(child);
        };
        walk(document.body);
        return texts.join(' ');
        """
    )
    assert "time [s]" in shown
    assert "speed [m/s]" in shown


def test_a_report_may_hold_a_video(
    browser: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The browser knows how long it is."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    pytest.importorskip("imageio_ffmpeg")
    try:
        opengl.backend_name()
    except RenderingError as error:
        pytest.skip(str(error))
    monkeypatch.chdir(tmp_path)
    result = command("run", "row_3", "--duration", "0.4", "--html", "v.html", "--video")
    assert result.exit_code == 0, result.output
    opened(browser, tmp_path / "v.html")
    for _ in range(50):
        length = browser.execute_script(
            "return document.querySelector('video').duration"
        )
        if length:
            break
        time.sleep(0.1)
    # 11 pictures of 40 ms
    assert length == pytest.approx(0.44, abs=0.02)
