"""One way to share out independent work: any executor of `concurrent.futures`.

`in_order` is what everything that maps uses. Executors of other libraries have the same
interface: `dask.distributed.Client.get_executor()`, `mpi4py.futures.MPIPoolExecutor`,
`loky.get_reusable_executor()`. Results do not depend on the executor and come in the
order of the tasks.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from multiprocessing.connection import Connection
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
    parts: int = CHUNKS,
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
        parts: About how many parts the work is cut into. The results of a part come
            together.

    Raises:
        ConfigError: If `executor` has no `submit`, or both it and `processes` are
            given.
        WorkerError: If workers are lost again and again.
    """
    count = check_workers(executor, processes)
    work = list(tasks)
    if executor is None and min(count, len(work)) <= 1:
        return map(function, work)
    shares = _parts(work, cost, parts)
    if executor is not None:
        return _each(_elsewhere(executor, function, shares))
    return _each(_on_this_machine(function, shares, min(count, len(shares))))


def check_workers(executor: Executor | None, processes: int | None) -> int:
    """Returns the number of processes to start.

    Args:
        executor: See `in_order`.
        processes: See `in_order`.

    Raises:
        ConfigError: If one of them is not valid, or both are given.
    """
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
    tasks: Sequence[Task], cost: Callable[[Task], float] | None, count: int
) -> list[list[Task]]:
    """Cuts tasks into so many parts of about the same cost, in order."""
    costs = [1.0 if cost is None else cost(task) for task in tasks]
    share = sum(costs) / count
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
    try:
        return [function(task) for task in part]
    except Exception as error:
        raise _portable(error) from error


def _portable(error: Exception) -> Exception:
    """Returns an error that other processes can read.

    One that cannot be read there is taken for a process that was lost.
    """
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return WorkerError(f"{type(error).__name__}: {error}")
    return error


def _each(parts: Iterator[list[Result]]) -> Iterator[Result]:
    """Yields the results of parts one by one."""
    for results in parts:
        yield from results


def _submitted(
    executor: Executor,
    function: Callable[[Task], Result],
    parts: Sequence[Sequence[Task]],
) -> deque[Future[list[Result]]]:
    """Returns what will be the results of each part."""
    return deque(executor.submit(_run_part, function, part) for part in parts)


def _read(futures: deque[Future[list[Result]]]) -> Iterator[list[Result]]:
    """Yields results in order; those that are read are not kept."""
    while futures:
        yield futures.popleft().result()


def _elsewhere(
    executor: Executor,
    function: Callable[[Task], Result],
    parts: Sequence[Sequence[Task]],
) -> Iterator[list[Result]]:
    """Yields the results of each part from an executor of the caller."""
    futures = _submitted(executor, function, parts)
    try:
        yield from _read(futures)
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
        wanted, want = context.Pipe(duplex=False)
        pool = ProcessPoolExecutor(
            processes, mp_context=context, initializer=_follow, initargs=(wanted,)
        )
        try:
            for results in _read(_submitted(pool, function, parts[done:])):
                done += 1
                restarts = 0
                yield results
        except BrokenExecutor as error:
            restarts += 1
            if restarts > RESTARTS:
                msg = (
                    f"a process was lost {restarts} times in part {done + 1} of "
                    f"{len(parts)} of the work. It was killed, perhaps for want of "
                    "memory (use fewer processes), or it could not begin: a script "
                    "that uses processes starts under `if __name__ == '__main__':`"
                )
                raise WorkerError(msg) from error
        finally:
            # what no one reads any more is not waited for; the pool itself cancels
            # it, for a pool that breaks fails at a future that we had cancelled
            want.close()
            pool.shutdown(cancel_futures=True)
            wanted.close()


def _follow(wanted: Connection) -> None:
    """Begins a process that ends as soon as no one wants its results.

    Ctrl-C reaches every process of a terminal. It is for the one that gives out the
    work, or a process would hand an interruption over as its result.

    Args:
        wanted: What closes then, also if the other process is killed.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(wanted,), daemon=True).start()


def _end_with(wanted: Connection) -> None:
    """Ends this process once a connection closes."""
    with contextlib.suppress(EOFError, OSError):
        wanted.recv()
    os._exit(1)
