"""Sweeps by workers of dask."""

from __future__ import annotations

import logging
import os
import signal
from concurrent.futures import CancelledError
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import pytest

import mujoco_impact
from mujoco_impact import extras
from mujoco_impact.errors import ConfigError, MissingExtraError, WorkerError
from mujoco_impact.sweeping import cluster
from mujoco_impact.sweeping.cluster import dask_workers


def test_a_cluster_that_loses_a_worker_in_the_middle_loses_nothing(
    given: dict[str, Any], tmp_path: Path
) -> None:
    """And the file is that of one process, to the byte."""
    pytest.importorskip("distributed")
    given["grid"]["qvel"] = {"x1": {"from": 1, "to": 2, "count": 6}}
    with dask_workers(local=2) as executor:
        client = executor._client  # type: ignore[attr-defined]
        lost, _ = client.run(os.getpid).values()
        # what dask says of a worker that is gone
        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        killed = []

        def kill(done: int, _: int) -> None:
            if done == 3:
                os.kill(lost, signal.SIGKILL)
                killed.append(lost)

        out = tmp_path / "dask.csv"
        found = mujoco_impact.sweep(given, out, executor=executor, progress=kill)
    assert killed
    assert len(found.rows) == 24
    assert not found.failures
    mujoco_impact.sweep(given, tmp_path / "serial.csv", processes=1)
    assert out.read_bytes() == (tmp_path / "serial.csv").read_bytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "give either a scheduler or a number of local workers"),
        ({"local": 0}, "local = 0: must be >= 1"),
        ({"scheduler": "here"}, "'here': must be as tcp://10.0.0.1:8786"),
    ],
)
def test_bad_options_name_what_is_allowed(options: Any, message: str) -> None:
    with pytest.raises(ConfigError, match=message), dask_workers(**options):
        pass


def test_a_scheduler_that_is_not_there_is_told(monkeypatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "PATIENCE", 0.2)
    address = "tcp://127.0.0.1:9"
    with (
        pytest.raises(WorkerError, match=f"no workers at {address}"),
        dask_workers(scheduler=address),
    ):
        pass


class Killed(Exception):
    """What dask raises for work that was lost with several workers."""


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (CancelledError(), "the scheduler was lost, and work with it"),
        (Killed("four workers died"), "four workers died"),
    ],
)
def test_work_that_is_lost_is_told(monkeypatch, error, message) -> None:
    dask = MagicMock()
    dask.scheduler.KilledWorker = Killed
    for part in (dask.Client, dask.LocalCluster):
        part.return_value.__exit__.return_value = False
    monkeypatch.setattr(cluster, "require", lambda _: dask)
    with pytest.raises(WorkerError, match=message), dask_workers(local=1):
        raise error


def test_workers_of_another_version_are_refused() -> None:
    other = {**cluster._versions(), "mujoco": "2.0.0"}
    with pytest.raises(WorkerError, match=r"the worker at tcp://a:1 has mujoco 2\.0"):
        cluster._check_versions({"tcp://a:1": other})


def test_a_worker_without_the_package_is_told() -> None:
    distributed = pytest.importorskip("distributed")
    without = "import sys; sys.modules['mujoco_impact'] = None"
    with (
        distributed.LocalCluster(
            n_workers=1,
            threads_per_worker=1,
            dashboard_address=None,
            silence_logs=logging.CRITICAL,
            preload=without,
        ) as workers,
        pytest.raises(WorkerError, match=r"the worker at tcp://\S+ has no mujoco-imp"),
        dask_workers(scheduler=workers.scheduler_address),
    ):
        pass


class Late(Exception):
    """What the timeout of asyncio is under Python 3.10: no OSError."""


@pytest.mark.parametrize(
    ("options", "place"),
    [
        ({"local": 1}, "on this machine"),
        ({"scheduler": "tcp://10.0.0.1:8786"}, "at tcp://10.0.0.1:8786"),
    ],
)
def test_workers_that_do_not_come_in_time_are_told(monkeypatch, options, place) -> None:
    dask = MagicMock()
    dask.TimeoutError = Late
    dask.LocalCluster.return_value.__exit__.return_value = False
    dask.Client.side_effect = Late
    monkeypatch.setattr(cluster, "require", lambda _: dask)
    with (
        pytest.raises(WorkerError, match=f"no workers {place}: no answer"),
        dask_workers(**options),
    ):
        pass


def test_without_dask_it_says_how_to_get_it(monkeypatch) -> None:
    monkeypatch.setattr(extras, "is_installed", lambda _: False)
    with (
        pytest.raises(MissingExtraError, match=r"distributed is not .*\[cluster\]"),
        dask_workers(local=1),
    ):
        pass


def test_without_pyarrow_it_says_how_to_get_it(given, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(extras, "is_installed", lambda _: False)
    with pytest.raises(MissingExtraError, match=r"pyarrow is not .*\[cluster\]"):
        mujoco_impact.sweep(given, tmp_path / "rows.parquet")
