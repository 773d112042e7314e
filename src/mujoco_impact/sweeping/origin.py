"""Which sweep some rows are of: what stands beside them, so that none are mixed."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path
from typing import IO, Any

from mujoco_impact.errors import ImpactError, SweepError
from mujoco_impact.files import quoted
from mujoco_impact.source import read_spec
from mujoco_impact.sweeping.parameters import SECTIONS
from mujoco_impact.sweeping.scenes import source_of
from mujoco_impact.sweeping.specification import Specification

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


def origin_path(rows: Path) -> Path:
    """Returns the file that stands beside rows and tells which sweep they are of."""
    return rows.with_name(f"{rows.name}.sweep.json")


def origin_of(spec: Specification) -> dict[str, Any]:
    """Returns all that the rows of a sweep depend on, by what a message calls it."""
    return {
        "mujoco-impact": metadata.version("mujoco-impact"),
        "MuJoCo": metadata.version("mujoco"),
        **spec.fixed,
        **{
            f"{table}.{name}": value
            for table, values in spec.tables.items()
            for name, value in _by_name(values).items()
        },
        "record": list(spec.record),
        "repeats": spec.repeats,
        **{f"the file {name}": digest for name, digest in _digests(spec).items()},
    }


def _by_name(table: Mapping[str, Any]) -> dict[str, Any]:
    """Returns what a table says, tables in it by names such as "scene.gap"."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        if key in SECTIONS:
            found |= {f"{key}.{name}": one for name, one in value.items()}
        else:
            found[key] = value
    return found


def _digests(spec: Specification) -> dict[str, str]:
    """Returns a hash of each model file, with what it includes, by its name."""
    found: dict[str, str] = {}
    for case in spec.cases:
        name = str(case.get("scene.model", ""))
        if not name or name in found:
            continue
        try:
            xml = read_spec(source_of(case, spec.folder)).to_xml()
        except ImpactError as error:
            # its cases fail, too, and say so in their rows
            xml = str(error)
        found[name] = hashlib.sha256(xml.encode()).hexdigest()
    return found


@contextlib.contextmanager
def locked(rows: Path) -> Iterator[IO[str]]:
    """Keeps other processes from rows, and yields the file that tells what they are.

    Args:
        rows: File or folder of the rows.

    Raises:
        SweepError: If another sweep is writing them.
    """
    with origin_path(rows).open("a+", encoding="utf-8") as file:
        if fcntl is not None:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise SweepError(f"another sweep is writing {rows}") from error
        yield file


def claim(file: IO[str], rows: Path, spec: Specification) -> None:
    """Makes rows those of a sweep, if there are none yet.

    Args:
        file: What tells which sweep they are of.
        rows: File or folder of the rows.
        spec: What the sweep was asked for.

    Raises:
        SweepError: If there are rows of another sweep; says what differs.
    """
    origin = origin_of(spec)
    if not rows.exists():
        file.truncate(0)
        file.write(json.dumps(origin, indent=2) + "\n")
        file.flush()
        return
    file.seek(0)
    way = "write to another file, or throw these rows away and begin anew (--restart)"
    try:
        found: dict[str, Any] = dict(json.load(file))
    except ValueError as error:
        msg = f"{rows} is there, and {origin_path(rows).name} does not tell what it is"
        raise SweepError(f"{msg}: {way}") from error
    for name in dict.fromkeys([*found, *origin]):
        before, now = found.get(name), origin.get(name)
        # as text: 1 and 1.0 look different in a row
        if json.dumps(before) != json.dumps(now):
            told = f"{name} was {_told(before)}, and is {_told(now)}"
            msg = f"the rows in {rows} are those of another sweep: {told}; {way}"
            raise SweepError(msg)


def _told(value: Any) -> str:
    """Returns a value as a message tells it."""
    return "not given" if value is None else quoted(value)
