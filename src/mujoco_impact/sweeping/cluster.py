"""Workers of dask, on this machine or on others."""

from __future__ import annotations

import contextlib
import logging
import re
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from importlib import metadata
from typing import Any

from mujoco_impact.errors import ConfigError, WorkerError
from mujoco_impact.extras import require

PACKAGES = ("mujoco-impact", "mujoco")
"""What workers must have in the version that is here: results depend on it."""

_ADDRESS = re.compile(r"(tcp|tls|ucx|ws|wss)://\S+:\d+")

PATIENCE = 10.0
"""How long to wait for a scheduler and its first worker [s]."""


@contextlib.contextmanager
def dask_workers(
    *, scheduler: str | None = None, local: int | None = None
) -> Iterator[Executor]:
    """Yields an executor whose work is done by workers of dask.

    A worker that is lost loses nothing: its work is done again by another.

    Args:
        scheduler: Address of a scheduler, such as "tcp://10.0.0.1:8786".
        local: Number of workers to start on this machine, instead.

    Raises:
        MissingExtraError: If dask.distributed is not installed.
        ConfigError: If not one of the two is given, or `local` is not valid.
        WorkerError: If there is no scheduler, it has no workers, or they have other
            versions; or if work was lost with several workers, or the scheduler was.
    """
    if (scheduler is None) == (local is None):
        raise ConfigError("give either a scheduler or a number of local workers")
    if local is not None and local < 1:
        raise ConfigError(f"local = {local}: must be >= 1")
    if scheduler is not None and not _ADDRESS.fullmatch(scheduler):
        # a client that does not get so far waits for itself at its end
        msg = f"scheduler = {scheduler!r}: must be as tcp://10.0.0.1:8786"
        raise ConfigError(msg)
    distributed = require("distributed")
    with contextlib.ExitStack() as stack:
        if local is not None:
            address: Any = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=local,
                    # a process runs one case at a time
                    threads_per_worker=1,
                    dashboard_address=None,
                    silence_logs=logging.ERROR,
                )
            )
        else:
            address = scheduler
        try:
            client = stack.enter_context(
                distributed.Client(address, timeout=PATIENCE, set_as_default=False)
            )
            client.wait_for_workers(1, timeout=PATIENCE)
        # under Python 3.10 the timeout of asyncio is no OSError
        except (OSError, ValueError, distributed.TimeoutError) as error:
            place = "on this machine" if scheduler is None else f"at {scheduler}"
            msg = f"no workers {place}: {str(error) or 'no answer'}"
            raise WorkerError(msg) from error
        _check_versions(client.run(_versions, on_error="return"))
        try:
            yield client.get_executor()
        except distributed.scheduler.KilledWorker as error:
            raise WorkerError(" ".join(str(error).split())) from error
        except CancelledError as error:
            raise WorkerError("the scheduler was lost, and work with it") from error


def _versions() -> dict[str, str]:
    """Returns the versions that a worker has."""
    return {name: metadata.version(name) for name in PACKAGES}


def _check_versions(workers: dict[str, dict[str, str] | Exception]) -> None:
    """Raises WorkerError if workers have other versions than this process, or none."""
    here = _versions()
    for address, there in workers.items():
        if isinstance(there, Exception):
            msg = f"the worker at {address} has no mujoco-impact: {there}"
            raise WorkerError(msg) from there
        for name, version in here.items():
            if there[name] != version:
                msg = f"the worker at {address} has {name} {there[name]}, not {version}"
                raise WorkerError(msg)
