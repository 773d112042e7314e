"""The page of throughput beside MuJoCo Warp tells what ran, and where."""

import pytest

pytest.importorskip("mujoco_warp")

from mujoco_impact_lab.bench import warp_throughput


def test_the_page_names_the_device_and_the_numbers_of_worlds(tmp_path, monkeypatch):
    # ten steps, in which nothing strikes yet
    monkeypatch.setattr(warp_throughput, "DURATION", 0.02)
    page = tmp_path / "warp.md"
    warp_throughput.write_page(page, [1, 3], report=str)
    text = page.read_text(encoding="utf-8")
    assert "on Warp's CPU device" in text
    assert "No GPU was at hand" in text
    rows = [line.split("|")[1].strip() for line in text.splitlines() if "|" in line]
    assert rows == ["worlds", "---", "1", "3"]
