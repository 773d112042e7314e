"""The benchmark of environments measures what it says, and writes it down."""

import json

import pytest

pytest.importorskip("dm_control")
pytest.importorskip("gymnasium")
from mujoco_impact.envs import ALL_TASKS
from mujoco_impact.envs.tasks import TASKS
from mujoco_impact_lab.bench.environment_steps import STOCK, step_costs
from mujoco_impact_lab.bench.environments import write
from mujoco_impact_lab.bench.machine import machine, versions
from mujoco_impact_lab.bench.rollout_throughput import throughput
from mujoco_impact_lab.bench.vector_steps import VectorCost, vector_costs

VECTORS = VectorCost("cradle strike", 64, 10, 20, 30, 3.0, 1.5)


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
        "vectors": [VECTORS],
        "rollouts": throughput((1,), rollouts=2),
        "scores": "| task |\n",
    }
    data, page = write(results, tmp_path / "out")
    written = json.loads(data.read_text(encoding="utf-8"))
    assert written["steps"][0]["ratio"] == steps[0].ratio
    text = page.read_text(encoding="utf-8")
    for cost in steps:
        assert f"| {cost.environment} |" in text
    assert f"| {VECTORS.environment} | 64 | 10 | 20 | 30 |" in text
    assert "None" not in text


def test_every_vector_environment_is_measured(monkeypatch):
    monkeypatch.setattr("mujoco_impact_lab.bench.vector_steps.BLOCK", 4)
    monkeypatch.setattr("mujoco_impact_lab.bench.vector_steps.SIZES", (2,))
    told = []
    costs = vector_costs(2, told.append)
    assert told[-1] == 1
    names = [" ".join(game) for game in ALL_TASKS]
    assert [cost.environment for cost in costs] == names
    for cost in costs:
        assert cost.environments == 2
        assert min(cost.loop, cost.sync, cost.ours) > 0
        assert cost.over_loop > 0
        assert cost.over_sync > 0
