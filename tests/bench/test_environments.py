"""The benchmark of environments measures what it says, and writes it down."""

import json

import pytest

pytest.importorskip("dm_control")
pytest.importorskip("gymnasium")
from mujoco_impact.envs.tasks import TASKS
from mujoco_impact_lab.bench.environment_steps import STOCK, step_costs
from mujoco_impact_lab.bench.environments import write
from mujoco_impact_lab.bench.machine import machine, versions
from mujoco_impact_lab.bench.rollout_throughput import throughput


def test_results_of_rollouts_do_not_depend_on_threads():
    one, two = throughput((1, 2), rollouts=6)
    assert one.result == two.result
    assert (one.threads, two.threads) == (1, 2)
    assert one.rollouts_per_second > 0
    (other,) = throughput((1,), rollouts=5)
    assert other.result != one.result


def test_every_environment_is_measured_and_written(tmp_path):
    told = []
    steps = step_costs(2, told.append)
    assert told[-1] == 1
    assert len(steps) == 2 * len(TASKS) + len(STOCK)
    for cost in steps:
        assert 0 < cost.physics < cost.ours
        assert cost.overhead > 1
        assert cost.ratio > 0
    results = {
        "machine": machine(),
        "versions": versions([]),
        "steps": steps,
        "rollouts": throughput((1,), rollouts=2),
        "scores": "| task |\n",
    }
    data, page = write(results, tmp_path / "out")
    written = json.loads(data.read_text(encoding="utf-8"))
    assert written["steps"][0]["ratio"] == steps[0].ratio
    text = page.read_text(encoding="utf-8")
    for cost in steps:
        assert f"| {cost.environment} |" in text
    assert "None" not in text
