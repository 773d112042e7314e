"""Work that is shared out gives the same results, in order, whoever does it."""

import os
import signal
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mujoco_impact import executors
from mujoco_impact.errors import ConfigError, WorkerError


def square(x: int) -> int:
    return x * x


def die_once(mark: Path, x: int) -> int:
    """Kills its process at the task 5, the first time."""
    if x == 5 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return x * x


def die(_: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


class AtOnce(Executor):
    """Does the work when it is submitted, and counts the parts."""

    def __init__(self):
        self.parts = 0
        self.cancelled = 0

    def submit(self, function, /, *args, **kwargs):
        self.parts += 1
        future = Future()
        future.set_result(function(*args, **kwargs))
        future.cancel = self._cancel
        return future

    def _cancel(self):
        self.cancelled += 1
        return True


def test_results_come_in_order_from_any_executor():
    expected = [square(x) for x in range(300)]
    with ThreadPoolExecutor(3) as threads:
        shared = list(executors.in_order(square, range(300), executor=threads))
    assert shared == expected
    assert list(executors.in_order(square, range(300), processes=1)) == expected
    assert list(executors.in_order(square, range(300), processes=2)) == expected


def test_a_lost_process_loses_nothing(tmp_path):
    work = partial(die_once, tmp_path / "mark")
    results = list(executors.in_order(work, range(20), processes=2))
    assert results == [square(x) for x in range(20)]
    assert (tmp_path / "mark").exists()


def test_work_that_kills_every_process_is_an_error():
    with pytest.raises(WorkerError, match="lost 4 times in part 1 of 2"):
        list(executors.in_order(die, range(2), processes=2))


def test_work_that_is_not_wanted_any_more_is_cancelled():
    executor = AtOnce()
    results = executors.in_order(square, range(10), executor=executor)
    assert next(results) == 0
    results.close()
    assert executor.cancelled == 9


@given(st.lists(st.floats(0.1, 100), min_size=1, max_size=500))
def test_parts_cost_about_the_same(costs):
    parts = executors._parts(costs, lambda cost: cost)
    assert [cost for part in parts for cost in part] == costs
    share = sum(costs) / executors.CHUNKS
    # the last task of a part may be over half beyond its share
    assert all(sum(part[:-1]) <= share for part in parts)
    assert len(parts) <= 2 * executors.CHUNKS


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"processes": 0}, "processes = 0: must be >= 1"),
        ({"executor": 3}, "executor = 3: allowed: anything with the interface"),
        ({"executor": AtOnce(), "processes": 2}, "give one of them"),
    ],
)
def test_bad_options_name_what_is_allowed(options, message):
    with pytest.raises(ConfigError, match=message):
        executors.in_order(square, range(3), **options)
