"""Work that is shared out gives the same results, in order, whoever does it."""

import os
import signal
import subprocess
import sys
import time
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


class TwoPartsError(Exception):
    """Cannot be read in another process: it is made anew of one argument."""

    def __init__(self, what: str, where: str):
        super().__init__(f"{what} in {where}")


def fail(_: int) -> int:
    raise TwoPartsError("nonsense", "a worker")


def test_an_error_that_cannot_be_sent_comes_back_as_its_text():
    with pytest.raises(WorkerError, match="TwoPartsError: nonsense in a worker"):
        list(executors.in_order(fail, range(2), processes=2))


def test_work_that_kills_every_process_is_an_error():
    with pytest.raises(WorkerError, match="lost 4 times in part 1 of 2"):
        list(executors.in_order(die, range(2), processes=2))


def test_work_that_is_not_wanted_any_more_is_cancelled():
    executor = AtOnce()
    results = executors.in_order(square, range(10), executor=executor)
    assert next(results) == 0
    results.close()
    assert executor.cancelled == 9


ENDLESS = """
import os, signal, sys, time
from pathlib import Path
from mujoco_impact import executors

def sleep(folder):
    (folder / str(os.getpid())).touch()
    time.sleep(600)

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        list(executors.in_order(sleep, [Path(sys.argv[1])] * 9, processes=2))
    except KeyboardInterrupt:
        sys.exit("interrupted")
"""


def running(process: int) -> bool:
    """Whether a process runs; one that has ended may wait to be told of."""
    try:
        status = Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False
    return status.rpartition(")")[2].split()[0] != "Z"


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc")
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_processes_end_with_the_one_that_wants_their_results(tmp_path, end):
    """Ctrl-C reaches all of them, and none waits for its work to be done."""
    script = tmp_path / "endless.py"
    script.write_text(ENDLESS)
    begun = tmp_path / "begun"
    begun.mkdir()
    main = subprocess.Popen(
        [sys.executable, str(script), str(begun)],
        start_new_session=True,
        stderr=subprocess.PIPE,
        text=True,
    )
    while len(list(begun.iterdir())) < 2:
        assert main.poll() is None
        time.sleep(0.05)
    workers = [int(file.name) for file in begun.iterdir()]
    if end == signal.SIGINT:
        os.killpg(main.pid, end)
        assert main.communicate()[1] == "interrupted\n"
    else:
        main.kill()
        main.communicate()
    # a fault leaves them there for ten minutes, and the test, too
    while any(map(running, workers)):
        time.sleep(0.05)


@given(
    st.lists(st.floats(0.1, 100), min_size=1, max_size=500), st.sampled_from([7, 64])
)
def test_parts_cost_about_the_same(costs, count):
    executor = AtOnce()
    # one task a part, as those of the number of tasks are
    list(executors.in_order(square, costs, executor=executor, parts=10**6))
    assert executor.parts == len(costs)
    parts = executors._parts(costs, lambda cost: cost, count)
    assert [cost for part in parts for cost in part] == costs
    share = sum(costs) / count
    # the last task of a part may be over half beyond its share
    assert all(sum(part[:-1]) <= share for part in parts)
    assert len(parts) <= 2 * count


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
