"""A sweep from its specification to its rows."""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import os
from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path

from mujoco_impact.errors import SweepError, SweepInterrupted
from mujoco_impact.executors import check_workers, in_order
from mujoco_impact.sweeping.origin import claim, locked, read_origin
from mujoco_impact.sweeping.quantities import check_parts
from mujoco_impact.sweeping.rows_file import RowsFile, rows_file
from mujoco_impact.sweeping.run_case import (
    ERROR,
    REMARKS,
    names_in,
    run_case,
)
from mujoco_impact.sweeping.specification import (
    Given,
    Specification,
    read_specification,
)
from mujoco_impact.sweeping.table import (
    CASE,
    Column,
    Row,
    beginnings,
    columns_of,
    tasks_of,
)

PARTS = 1000
"""Parts that the cases are handed out in, at most. A part comes back whole: many of
them, so that an interruption loses little."""


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """The rows of a sweep.

    Attributes:
        specification: What was asked for.
        columns: Name, kind and unit of each column.
        rows: A dictionary by the names of columns for each case and repeat, in order;
            None stands where something is not known.
    """

    specification: Specification
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]

    def __repr__(self) -> str:
        """Returns what is in it, in one line."""
        return f"<Sweep: {len(self.rows)} rows, {len(self.failures)} failed>"

    @property
    def failures(self) -> tuple[Row, ...]:
        """The rows of cases that failed; the column `error` says why."""
        return tuple(row for row in self.rows if row[ERROR])

    @property
    def remarked(self) -> tuple[Row, ...]:
        """The rows of which there is something to say, in the column `remarks`."""
        return tuple(row for row in self.rows if row[REMARKS])

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draws what was varied against what was recorded; needs the extra `plot`.

        Args:
            path: PNG (or other image) file to write.

        Returns:
            The path written.

        Raises:
            MissingExtraError: If matplotlib is not installed.
            SweepError: If there is nothing to draw.
        """
        from mujoco_impact.sweeping.plot import plot_sweep

        return plot_sweep(self, path)


def sweep(
    specification: Given,
    out: str | os.PathLike[str] | None = None,
    *,
    executor: Executor | None = None,
    processes: int | None = None,
    restart: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Sweep:
    """Runs a scene with many parameters, and records what each case comes to.

    A case that fails is a row with its error. The rows come in the order of the cases,
    and are the same whoever computes them; only run times differ. A file of rows grows
    as they come, and a sweep that was interrupted goes on where it stopped.

    Args:
        specification: A TOML file, or a mapping of what would stand in one.
        out: File to write rows to, ending with .csv, or with .parquet (a folder, extra
            `cluster`). None: they are only returned.
        executor: Where to run the cases: anything with the interface of
            `concurrent.futures.Executor`. By default processes of this machine.
        processes: Number of processes of this machine, instead of an executor; 1 runs
            the cases in this process. By default one for each processor.
        restart: Whether to throw away the rows that are there, if a sweep wrote them.
        progress: Called with the number of rows there are, and will be.

    Raises:
        ConfigError: If something in the specification is not valid; names the key, its
            value and what is allowed. If both `executor` and `processes` are given, or
            one is not valid.
        SceneError: If the first case has no scene.
        SweepError: If there are rows of another specification, or what no sweep wrote.
        WorkerError: If workers are lost again and again; the rows until then are there.
        SweepInterrupted: On Ctrl-C; the rows until then are there.
    """
    check_workers(executor, processes)
    spec = _with_bodies(read_specification(specification))
    rows = _Rows(spec, progress)
    if out is None:
        rows.go_on(None, executor, processes)
        return rows.sweep()
    path = Path(out)
    if not path.parent.is_dir():
        raise SweepError(f"cannot write {path}: there is no folder {path.parent}")
    file = rows_file(path, rows.columns)
    with locked(path) as origin, contextlib.closing(file):
        if restart and path.exists():
            # of what is not ours nothing is thrown away
            read_origin(origin, path)
            file.remove()
        claim(origin, path, spec)
        rows.take(file.read(), path)
        rows.go_on(file, executor, processes)
    return rows.sweep()


class _Rows:
    """The rows of a sweep, those of a file first, then those that are run."""

    def __init__(
        self, spec: Specification, progress: Callable[[int, int], None] | None
    ) -> None:
        self.columns = columns_of(spec)
        self._rows: list[Row] = []
        self._spec = spec
        self._total = len(spec.cases) * spec.repeats
        self._progress = progress or (lambda _done, _total: None)

    def sweep(self) -> Sweep:
        """Returns the rows there are."""
        return Sweep(self._spec, self.columns, tuple(self._rows))

    def take(self, rows: list[Row], path: Path) -> None:
        """Takes the rows of a file; SweepError if they are not the first ones."""
        beginning = itertools.islice(beginnings(self._spec), len(rows))
        beyond: itertools.repeat[Row] = itertools.repeat({CASE: None})
        expected = itertools.chain(beginning, beyond)
        for number, (row, known) in enumerate(zip(rows, expected, strict=False)):
            if any(row[name] != cell for name, cell in known.items()):
                msg = f"row {number + 1} of {path} is not of this sweep (--restart)"
                raise SweepError(msg)
        self._rows = rows

    def go_on(
        self,
        file: RowsFile | None,
        executor: Executor | None,
        processes: int | None,
    ) -> None:
        """Runs the cases that have no row yet."""
        done = len(self._rows)
        known = itertools.islice(beginnings(self._spec), done, None)
        results = in_order(
            run_case,
            itertools.islice(tasks_of(self._spec), done, None),
            executor=executor,
            processes=processes,
            cost=lambda task: task.cost,
            parts=PARTS,
        )
        empty: Row = {column.name: None for column in self.columns}
        self._progress(done, self._total)
        try:
            for beginning, found in zip(known, results, strict=True):
                row = {**empty, **beginning, **found}
                self._rows.append(row)
                if file is not None:
                    file.append(row)
                self._progress(len(self._rows), self._total)
        except KeyboardInterrupt:
            raise SweepInterrupted(len(self._rows), self._total) from None


def _with_bodies(spec: Specification) -> Specification:
    """Returns a specification in which velocities are asked for of each body by name.

    Makes the scene of the first case, so that what does not fit it is told before
    anything runs: what is recorded of a geom or a body, too.
    """
    geoms, bodies = names_in(spec.cases[0], spec.folder)
    record: list[str] = []
    for name in spec.record:
        check_parts(name, geoms, bodies)
        if name == "velocity_after":
            record += [f"{name}.{body}" for body in bodies]
        else:
            record.append(name)
    return dataclasses.replace(spec, record=tuple(dict.fromkeys(record)))
