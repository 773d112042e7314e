"""Writing the impacts of a run to a file for other programs."""

from __future__ import annotations

import csv
import importlib
import os
from collections.abc import Sequence
from pathlib import Path

from mujoco_impact.errors import ConfigError, MissingExtraError
from mujoco_impact.files import check_writable, replacing
from mujoco_impact.impact import Impact, impact_columns

ENDINGS = (".csv", ".parquet")


def check_impact_file(path: str | os.PathLike[str]) -> None:
    """Raises if impacts cannot be written to a file, before there are any.

    Raises:
        ConfigError: If its ending is not one of `ENDINGS`.
        MissingExtraError: If what writes it is not installed.
        OSError: If it cannot be written.
    """
    ending = Path(path).suffix
    if ending not in ENDINGS:
        msg = f"impacts go to files that end in {' or '.join(ENDINGS)}, not {path}"
        raise ConfigError(msg)
    if ending == ".parquet":
        try:
            importlib.import_module("pyarrow.parquet")
        except ImportError as error:
            msg = "Parquet files need pyarrow: run `pip install pyarrow`, or take .csv"
            raise MissingExtraError(msg) from error
    check_writable(path)


def write_impacts(impacts: Sequence[Impact], path: str | os.PathLike[str]) -> Path:
    """Writes impacts, one row each, columns as in `Trajectory.to_pandas`.

    Args:
        impacts: The impacts.
        path: File that ends in .csv or .parquet.
    """
    check_impact_file(path)
    columns = impact_columns(impacts)
    with replacing(path) as part:
        if part.suffix == ".csv":
            with part.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(columns)
                writer.writerows(zip(*(c.tolist() for c in columns.values()),
                                     strict=True))  # fmt: skip
        else:
            arrow = importlib.import_module("pyarrow")
            importlib.import_module("pyarrow.parquet").write_table(
                arrow.table({name: arrow.array(c) for name, c in columns.items()}), part
            )
    return Path(path)
