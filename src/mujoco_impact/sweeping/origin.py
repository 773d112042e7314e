"""Which sweep some rows are of: what stands beside them, so that none are mixed."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import IO, Any

import mujoco
import numpy as np

from mujoco_impact.errors import ImpactError, SweepError
from mujoco_impact.files import quoted
from mujoco_impact.source import read_spec
from mujoco_impact.specifications import compile_spec
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
            for name, value in values.items()
        },
        "record": list(spec.record),
        "repeats": spec.repeats,
        **{f"the file {name}": digest for name, digest in _digests(spec).items()},
    }


def _digests(spec: Specification) -> dict[str, str]:
    """Returns a hash of each model by its name, with all files that it reads."""
    found: dict[str, str] = {}
    for case in spec.cases:
        name = str(case.get("scene.model", ""))
        if not name or name in found:
            continue
        try:
            found[name] = _digest(read_spec(source_of(case, spec.folder)))
        except ImpactError as error:
            # its cases fail, too, and say so in their rows
            found[name] = hashlib.sha256(str(error).encode()).hexdigest()
    return found


def _digest(spec: mujoco.MjSpec) -> str:
    """Returns a hash of a model; SceneError if it cannot be compiled.

    The text tells all but what is in files of meshes and other data. That is in the
    arrays of the compiled model. Where the files lie does not count.
    """
    digest = hashlib.sha256(spec.to_xml().encode())
    model = compile_spec(spec)
    for name in dir(model):
        # private ones hold sizes, that of the paths, too
        if name.startswith("_") or name.endswith("_pathadr"):
            continue
        array = getattr(model, name)
        if isinstance(array, np.ndarray):
            digest.update(f"{name} {array.shape}".encode())
            digest.update(array.tobytes())
    return digest.hexdigest()


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
    found = read_origin(file, rows)
    for name in dict.fromkeys([*found, *origin]):
        before, now = found.get(name), origin.get(name)
        # as text: 1 and 1.0 look different in a row
        if json.dumps(before) != json.dumps(now):
            told = f"{name} was {_told(before)}, and is {_told(now)}"
            msg = (
                f"the rows in {rows} are those of another sweep: {told}; write to "
                "another file, or throw these rows away and begin anew (--restart)"
            )
            raise SweepError(msg)


def read_origin(file: IO[str], rows: Path) -> dict[str, Any]:
    """Returns what stands beside rows, and tells which sweep they are of.

    Args:
        file: Where it stands.
        rows: File or folder of the rows.

    Raises:
        SweepError: If it does not tell.
    """
    file.seek(0)
    try:
        return dict(json.load(file))
    except (TypeError, ValueError) as error:
        msg = (
            f"{rows} is there, and {origin_path(rows).name} does not tell what it is: "
            "write to another file, or take it away"
        )
        raise SweepError(msg) from error


def _told(value: Any) -> str:
    """Returns a value as a message tells it."""
    return "not given" if value is None else quoted(value)
