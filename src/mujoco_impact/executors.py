"""One way to share out independent work: any executor of `concurrent.futures`.

`in_order` is what everything that maps uses. Executors of other libraries have the same
interface: `dask.distributed.Client.get_executor()`, `mpi4py.futures.MPIPoolExecutor`,
`loky.get_reusable_executor()`. Results do not depend on the executor and come in the
order of the tasks.
"""

from __future__ import annotations

import multiprocessing
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from typing import TypeVar

from mujoco_impact.errors import ConfigError, WorkerError

Task = TypeVar("Task")
Result = TypeVar("Result")

CHUNKS = 64
"""Parts that work is cut into, about: enough for a few dozen workers to end together,
few enough for what a part costs besides its work."""

RESTARTS = 3
"""How often lost processes of this machine are replaced without a result between."""


def in_order(
    function: Callable[[Task], Result],
    tasks: Iterable[Task],
    *,
    executor: Executor | None = None,
    processes: int | None = None,
    cost: Callable[[Task], float] | None = None,
) -> Iterator[Result]:
    """Yields the results of tasks in their order, as they come.

    Work is cut into parts of about the same cost. What is not needed any more, because
    the caller stops or a task failed, is cancelled.

    Args:
        function: What to do with a task. Like tasks and results it has to be picklable,
            and it is called in this process if that is where the work is done.
        tasks: The tasks.
        executor: Where to do the work; it is not shut down. By default processes of
            this machine.
        processes: Number of processes of this machine, instead of an executor; 1 does
            the work in this process. By default one for each processor.
        cost: Relative cost of a task; by default all cost the same.

    Raises:
        ConfigError: If `executor` has no `submit`, or both it and `processes` are
            given.
        WorkerError: If workers are lost again and again.
    """
    count = _process_count(executor, processes)
    work = list(tasks)
    if executor is None and min(count, len(work)) <= 1:
        return map(function, work)
    parts = _parts(work, cost)
    if executor is not None:
        return _each(_submitted(executor, function, parts))
    return _each(_on_this_machine(function, parts, min(count, len(parts))))


def _process_count(executor: Executor | None, processes: int | None) -> int:
    """Returns the number of processes to start; ConfigError if that is not valid."""
    if executor is not None:
        if processes is not None:
            msg = f"executor and processes = {processes}: give one of them"
            raise ConfigError(msg)
        if not callable(getattr(executor, "submit", None)):
            msg = (
                f"executor = {executor!r}: allowed: anything with the interface of "
                "concurrent.futures.Executor, such as client.get_executor() of dask"
            )
            raise ConfigError(msg)
    if processes is not None and processes < 1:
        raise ConfigError(f"processes = {processes}: must be >= 1")
    return processes or os.cpu_count() or 1


def _parts(
    tasks: Sequence[Task], cost: Callable[[Task], float] | None
) -> list[list[Task]]:
    """Cuts tasks into parts of about the same cost, in order."""
    costs = [1.0 if cost is None else cost(task) for task in tasks]
    share = sum(costs) / CHUNKS
    parts: list[list[Task]] = []
    spent = share
    for task, one in zip(tasks, costs, strict=True):
        # a part takes what would leave it nearer to its share
        if spent + one / 2 >= share:
            parts.append([])
            spent = 0.0
        parts[-1].append(task)
        spent += one
    return parts


def _run_part(function: Callable[[Task], Result], part: Sequence[Task]) -> list[Result]:
    """Does the tasks of a part, in a worker."""
    return [function(task) for task in part]


def _each(parts: Iterator[list[Result]]) -> Iterator[Result]:
    """Yields the results of parts one by one."""
    for results in parts:
        yield from results


def _submitted(
    executor: Executor,
    function: Callable[[Task], Result],
    parts: Sequence[Sequence[Task]],
) -> Iterator[list[Result]]:
    """Yields the results of each part from an executor of the caller."""
    futures: deque[Future[list[Result]]] = deque(
        executor.submit(_run_part, function, part) for part in parts
    )
    try:
        while futures:
            # off the list first: a result that was read is not kept
            yield futures.popleft().result()
    finally:
        for future in futures:
            future.cancel()


def _on_this_machine(
    function: Callable[[Task], Result],
    parts: Sequence[Sequence[Task]],
    processes: int,
) -> Iterator[list[Result]]:
    """Yields the results of each part from processes, lost ones replaced."""
    done = restarts = 0
    while done < len(parts):
        # a fresh interpreter: a fork would share MuJoCo's threads and handlers
        context = multiprocessing.get_context("spawn")
        pool = ProcessPoolExecutor(processes, mp_context=context)
        try:
            for results in _submitted(pool, function, parts[done:]):
                done += 1
                restarts = 0
                yield results
        except BrokenExecutor as error:
            restarts += 1
            if restarts > RESTARTS:
                msg = (
                    f"a process was lost {restarts} times in part {done + 1} of "
                    f"{len(parts)} of the work; it was killed, perhaps for want of "
                    "memory: use fewer processes"
                )
                raise WorkerError(msg) from error
        finally:
            pool.shutdown(cancel_futures=True)
