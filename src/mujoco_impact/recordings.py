"""What is kept of a run: how long it may be, and reading its arrays from a file.

The header of an array may claim any shape, and NumPy asks for that memory before it
reads the numbers.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterable
from typing import IO, Any, TypeAlias

import numpy as np
import numpy.typing as npt

LARGEST_RECORDING = 4_000_000_000
"""Most bytes that a run keeps, or that are read of a trajectory file."""

MOST_STEPS = 2**53
"""Most steps of a run: a double counts no further."""


def steps_of(duration: float, timestep: float) -> int:
    """Returns the number of steps that make up a duration, at least 1.

    Args:
        duration: Simulated time [s].
        timestep: Of the model [s].

    Raises:
        ValueError: If the duration is not a positive time, or too long.
    """
    if not (math.isfinite(duration) and duration > 0):
        msg = f"duration = {duration}: must be a time > 0 [s]"
        raise ValueError(msg)
    if duration / timestep > MOST_STEPS:
        msg = f"duration = {duration}: more than 2^53 steps of {timestep:g} s"
        raise ValueError(msg)
    return max(1, round(duration / timestep))


def check_recording(samples: int, numbers: int) -> None:
    """Raises ValueError if samples of so many numbers each are more than is kept."""
    size = 8 * samples * numbers
    if size > LARGEST_RECORDING:
        msg = (
            f"{samples:.3g} samples of {numbers} numbers take {size:.3g} bytes, "
            f"allowed: {LARGEST_RECORDING:.3g}; run shorter, or keep fewer samples"
        )
        raise ValueError(msg)


AnyArray: TypeAlias = npt.NDArray[Any]

_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}
"""How the header of each version of the format is read."""


def read_arrays(stream: IO[bytes], names: Iterable[str]) -> dict[str, AnyArray]:
    """Returns arrays of an .npz file by name.

    Args:
        stream: The file.
        names: The arrays to read; others are left alone.

    Raises:
        ValueError: If an array is missing, is there twice or is none, or if all of
            them are larger than `LARGEST_RECORDING`.
        Exception: Whatever zipfile, zlib and NumPy raise for damaged files.
    """
    with zipfile.ZipFile(stream) as archive:
        members: dict[str, zipfile.ZipInfo] = {}
        for member in archive.infolist():
            if member.filename in members:
                raise ValueError(f"it holds {member.filename!r} twice")
            members[member.filename] = member
        wanted = {name: _member(members, name) for name in names}
        size = sum(member.file_size for member in wanted.values())
        if size > LARGEST_RECORDING:
            msg = f"its arrays have {size:.3g} bytes, allowed: {LARGEST_RECORDING:.3g}"
            raise ValueError(msg)
        return {
            name: _read_array(archive, name, member) for name, member in wanted.items()
        }


def _member(members: dict[str, zipfile.ZipInfo], name: str) -> zipfile.ZipInfo:
    """Returns the part of an archive that holds an array."""
    member = members.get(f"{name}.npy")
    if member is None:
        raise ValueError(f"it has no array {name!r}")
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"array {name!r} is compressed in another way than NumPy's")
    return member


def _read_array(
    archive: zipfile.ZipFile, name: str, member: zipfile.ZipInfo
) -> AnyArray:
    """Returns an array whose header claims no more than there is."""
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        if version not in _HEADERS:
            raise ValueError(f"array {name!r} is of version {version} of the format")
        shape, _, dtype = _HEADERS[version](file)
        claimed = math.prod(shape) * dtype.itemsize
        if dtype.hasobject or claimed != member.file_size - file.tell():
            msg = f"array {name!r} claims shape {shape} of {dtype}, which is not there"
            raise ValueError(msg)
    with archive.open(member) as file:
        array: AnyArray = np.lib.format.read_array(file, allow_pickle=False)
    return array
