"""One impact, and many of them as a table."""

from __future__ import annotations

import csv
import dataclasses
import importlib
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from mujoco_impact.errors import ConfigError, MissingExtraError
from mujoco_impact.files import check_writable, replacing

Vector: TypeAlias = tuple[float, float, float]
"""Three numbers, in the world frame."""


@dataclasses.dataclass(frozen=True)
class Impact:
    """One impact between two geoms: a force pulse with an impulse and a duration.

    Attributes:
        time: Onset [s].
        geoms: Names of the two geoms ("geom 3" for an unnamed one).
        impulse: Normal impulse P [N s].
        alpha: Impulse over that of the contact of the island that closed first,
            alpha_k [-].
        height: Peak force of the waveform, H = pi P / (2 W) [N].
        duration: Duration of the waveform, W [s].
        restitution: Expansion impulse over compression impulse [-].
        peak: Largest force of the contact [N]: that of the Hertz contact (1.17 H for a
            single one), or H if pulses last as long as a setting says.
        closing_speed: Speed along the normal at which the two surfaces met [m/s]; 0 or
            less where touching bodies were pressed together by an impact beside them.
        position: Where the surfaces met, world frame [m].
        normal: Direction of the impulse on the second geom, world frame, length 1.
        tangential_impulse: Impulse of friction on the second geom, world frame [N s].
    """

    time: float
    geoms: tuple[str, str]
    impulse: float
    alpha: float
    height: float
    duration: float
    restitution: float
    peak: float
    closing_speed: float
    position: Vector
    normal: Vector
    tangential_impulse: Vector = (0.0, 0.0, 0.0)

    def force(self, time: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Returns the normal force of the waveform at some times [N], any shape.

        A quarter sine that rises to `height`, and one that falls; 0 before the onset
        and after the end. Its integral over time is `impulse`.

        Args:
            time: Simulated times [s].
        """
        from mujoco_impact import law

        phase = (np.asarray(time, dtype=np.float64) - self.time) / self.duration
        shape = np.vectorize(law.waveform_force, otypes=[np.float64])
        return np.asarray(self.impulse / self.duration * shape(phase, self.restitution))


_NUMBERS = np.dtype(
    [
        ("time", np.float64),
        ("impulse", np.float64),
        ("alpha", np.float64),
        ("height", np.float64),
        ("duration", np.float64),
        ("restitution", np.float64),
        ("peak", np.float64),
        ("closing_speed", np.float64),
        ("position", np.float64, 3),
        ("normal", np.float64, 3),
        ("tangential_impulse", np.float64, 3),
    ]
)
"""What is a number of an impact, in the order of files and tables."""

COLUMNS = _NUMBERS.itemsize // 8
"""Numbers of an impact, vectors counted by their components."""


def numbers_of(impacts: Sequence[Impact]) -> npt.NDArray[np.float64]:
    """Returns the numbers of impacts, one row each, shape (n, COLUMNS)."""
    rows = [tuple(getattr(one, name) for name in _names()) for one in impacts]
    table = np.array(rows, dtype=_NUMBERS)
    return table.view(np.float64).reshape(len(impacts), COLUMNS)


def impacts_of(
    numbers: npt.NDArray[np.float64], geoms: npt.NDArray[np.str_]
) -> tuple[Impact, ...]:
    """Returns the impacts of their numbers, shape (n, COLUMNS), and names (n, 2)."""
    table = np.ascontiguousarray(numbers, dtype=np.float64).view(_NUMBERS)
    return tuple(
        Impact(geoms=(str(pair[0]), str(pair[1])), **_fields(row))
        for pair, row in zip(geoms, table.reshape(len(geoms)), strict=True)
    )


def impacts_table(impacts: Sequence[Impact]) -> npt.NDArray[Any]:
    """Returns impacts as a structured array, shape (n,): geom1, geom2, the numbers."""
    names = np.array([one.geoms for one in impacts], dtype=np.str_).reshape(-1, 2)
    kind = names.dtype if len(impacts) else np.dtype("U1")
    table = np.zeros(len(impacts), [("geom1", kind), ("geom2", kind), *_NUMBERS.descr])
    table["geom1"], table["geom2"] = names[:, 0], names[:, 1]
    numbers = numbers_of(impacts).view(_NUMBERS).reshape(len(impacts))
    for name in _names():
        table[name] = numbers[name]
    return table


def impact_columns(impacts: Sequence[Impact]) -> dict[str, npt.NDArray[Any]]:
    """Returns impacts as plain columns: vectors as position_x and so on."""
    table = impacts_table(impacts)
    columns = {}
    for name in table.dtype.names or ():
        if table[name].ndim == 1:
            columns[name] = table[name]
            continue
        for axis, letter in enumerate("xyz"):
            columns[f"{name}_{letter}"] = table[name][:, axis]
    return columns


def _names() -> tuple[str, ...]:
    """Returns the names of the numbers."""
    return _NUMBERS.names or ()


def _fields(row: Any) -> dict[str, Any]:
    """Returns the numbers of one row by name."""
    return {
        name: tuple(row[name].tolist()) if row[name].ndim else float(row[name])
        for name in _names()
    }


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
