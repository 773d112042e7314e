"""Rows on disk, written as they come: CSV, or a folder of Parquet files.

What an interruption left half done is cut off, so that the rows end as if there had
been none.
"""

from __future__ import annotations

import csv
import io
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

from mujoco_impact.errors import SweepError
from mujoco_impact.extras import require
from mujoco_impact.files import replacing
from mujoco_impact.sweeping.quantities import INTEGER, NUMBER, TEXT
from mujoco_impact.sweeping.table import Column, Row, of_text, to_text

PART_ROWS = 1000
"""Rows of a file of a Parquet folder. The last file is written anew when rows come."""

PART_SECONDS = 0.5
"""How long rows wait for the next such writing, at most, if others follow [s]."""

_ENDINGS = (".csv", ".parquet")
_HALF = ".*.parquet"
"""Files of a folder whose writing was interrupted."""


class RowsFile(Protocol):
    """Where rows go."""

    def read(self) -> list[Row]:
        """Returns the rows that are there; what is half a row is cut off."""

    def append(self, row: Row) -> None:
        """Adds a row."""

    def close(self) -> None:
        """Ends writing; every row is there."""

    def remove(self) -> None:
        """Throws the rows away that are there."""


def rows_file(path: Path, columns: Sequence[Column]) -> RowsFile:
    """Returns the file of rows at a path, by its ending.

    Raises:
        SweepError: If the ending is another one.
        MissingExtraError: If pyarrow is needed, and not installed.
    """
    if path.suffix == ".csv":
        return CsvFile(path, columns)
    if path.suffix == ".parquet":
        return ParquetFolder(path, columns)
    msg = f"cannot write rows to {path}: its name must end with {' or '.join(_ENDINGS)}"
    raise SweepError(msg)


class CsvFile:
    """Rows as lines of text, the names of the columns first."""

    def __init__(self, path: Path, columns: Sequence[Column]) -> None:
        """Knows where the rows go; nothing is written yet."""
        self._path, self._columns = path, columns
        self._file: io.BufferedWriter | None = None

    def read(self) -> list[Row]:
        """Returns the rows that are there; what is half a row is cut off."""
        if not self._path.exists():
            return []
        content = self._path.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        if len(whole) < len(content):
            os.truncate(self._path, len(whole))
        if not whole:
            return []
        try:
            heading, *lines = csv.reader(io.StringIO(whole.decode("utf-8"), newline=""))
            if heading != [column.name for column in self._columns]:
                raise ValueError(f"its columns are {', '.join(heading)}")
            return [self._row(line) for line in lines]
        except (ValueError, csv.Error) as error:
            msg = f"{self._path} does not hold rows of this sweep: {error}"
            raise SweepError(msg) from error

    def _row(self, line: Sequence[str]) -> Row:
        """Returns the row of a line; ValueError if it does not fit the columns."""
        return {
            column.name: of_text(text, column.kind)
            for column, text in zip(self._columns, line, strict=True)
        }

    def append(self, row: Row) -> None:
        """Adds a line, in one piece."""
        if self._file is None:
            self._file = self._path.open("ab")
            if not self._file.tell():
                self._file.write(_line([column.name for column in self._columns]))
        cells = [to_text(row.get(column.name)) for column in self._columns]
        self._file.write(_line(cells))
        # with the system now: it stays if this process is killed
        self._file.flush()

    def close(self) -> None:
        """Ends writing."""
        if self._file is not None:
            self._file.close()

    def remove(self) -> None:
        """Throws the rows away."""
        self._path.unlink()


def _line(cells: Sequence[str]) -> bytes:
    """Returns a line of a CSV file."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode("utf-8")


class ParquetFolder:
    """Rows as files of `PART_ROWS` rows in a folder, as pandas and pyarrow read it."""

    def __init__(self, path: Path, columns: Sequence[Column]) -> None:
        """Knows where the rows go; nothing is written yet."""
        self._folder, self._columns = path, columns
        self._arrow, self._parquet = require("pyarrow"), require("pyarrow.parquet")
        types = {
            INTEGER: self._arrow.int64(),
            NUMBER: self._arrow.float64(),
            TEXT: self._arrow.string(),
        }
        self._schema = self._arrow.schema(
            [(column.name, types[column.kind]) for column in columns]
        )
        self._full = 0
        self._rows: list[Row] = []
        self._written = 0
        self._when = -PART_SECONDS

    def read(self) -> list[Row]:
        """Returns the rows that are there; what is half a file is deleted."""
        if not self._folder.exists():
            return []
        for left in self._folder.glob(_HALF):
            left.unlink()
        rows: list[Row] = []
        while (part := self._part(len(rows) // PART_ROWS)).exists():
            rows += self._part_rows(part)
            if len(rows) % PART_ROWS:
                break
        self._full, last = divmod(len(rows), PART_ROWS)
        self._rows = rows[len(rows) - last :]
        self._written = last
        return rows

    def _part(self, number: int) -> Path:
        """Returns a file of the folder."""
        return self._folder / f"part-{number:05d}.parquet"

    def _part_rows(self, part: Path) -> list[Row]:
        """Returns the rows of a file."""
        try:
            table = self._parquet.read_table(part)
        except (OSError, self._arrow.ArrowException) as error:
            raise SweepError(f"cannot read {part}: {error}") from error
        if not table.schema.equals(self._schema):
            shown = ", ".join(table.schema.names)
            msg = f"{part} does not hold rows of this sweep: its columns are {shown}"
            raise SweepError(msg)
        rows: list[Row] = table.to_pylist()
        return rows

    def append(self, row: Row) -> None:
        """Adds a row."""
        self._rows.append(row)
        full = len(self._rows) == PART_ROWS
        if full or time.monotonic() - self._when > PART_SECONDS:
            self._write()
        if full:
            self._full += 1
            self._rows, self._written = [], 0

    def _write(self) -> None:
        """Writes the last file anew, whole or not at all."""
        self._folder.mkdir(exist_ok=True)
        columns: dict[str, Any] = {
            column.name: [row.get(column.name) for row in self._rows]
            for column in self._columns
        }
        table = self._arrow.table(columns, schema=self._schema)
        with replacing(self._part(self._full)) as part:
            self._parquet.write_table(table, part)
        self._written, self._when = len(self._rows), time.monotonic()

    def close(self) -> None:
        """Ends writing; every row is there."""
        if len(self._rows) > self._written:
            self._write()

    def remove(self) -> None:
        """Throws the rows away; SweepError if something else is with them."""
        ours = {*self._folder.glob("part-*.parquet"), *self._folder.glob(_HALF)}
        for file in self._folder.iterdir():
            if file not in ours:
                msg = f"{file} is no file of rows: write to another folder, or take "
                raise SweepError(msg + "it away")
        for file in ours:
            file.unlink()
        self._folder.rmdir()
