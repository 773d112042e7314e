"""What a run leaves behind: sampled states, energies and the impacts."""

from __future__ import annotations

import dataclasses
import os
import struct
import zipfile
import zlib
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from mujoco_impact.errors import TrajectoryError

Array: TypeAlias = npt.NDArray[np.float64]

LAYOUT_VERSION = 2
"""Version of the .npz layout that `Trajectory.save` writes; 1 is read, too."""

_DAMAGE = (
    OSError,
    ValueError,
    KeyError,
    TypeError,
    EOFError,
    OverflowError,
    RuntimeError,  # zipfile: encrypted, or NotImplementedError
    SyntaxError,  # numpy: the header of an array
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)
"""What NumPy and zipfile raise, depending on which bytes are wrong."""

_ARRAYS = ("time", "qpos", "qvel", "energy")
_SCALARS = ("timestep", "integrator", "mujoco_version", "missed_impacts")


@dataclasses.dataclass(frozen=True)
class Impact:
    """One impact between two geoms: an artificial impulse waveform.

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
    """

    time: float
    geoms: tuple[str, str]
    impulse: float
    alpha: float
    height: float
    duration: float
    restitution: float
    peak: float


_IMPACT_NUMBERS = (
    "time",
    "impulse",
    "alpha",
    "height",
    "duration",
    "restitution",
    "peak",
)


@dataclasses.dataclass(frozen=True, eq=False)
class Trajectory:
    """A simulated motion, sampled at constant intervals.

    Attributes:
        time: Time of each sample [s], shape (n_samples,).
        qpos: Generalized positions (joint units: [m], [rad], quaternions), shape
            (n_samples, nq).
        qvel: Generalized velocities [m/s, rad/s], shape (n_samples, nv).
        energy: Potential and kinetic energy as MuJoCo counts them [J], shape
            (n_samples, 2).
        impacts: The impacts that began during the run, in order of time.
        timestep: Simulation timestep [s].
        integrator: Name of the integrator, for example "Euler".
        mujoco_version: Version of MuJoCo that made the run.
        missed_impacts: Impacts that began but whose record was overwritten before it
            could be read; 0 unless a warning was given.
    """

    time: Array
    qpos: Array
    qvel: Array
    energy: Array
    impacts: tuple[Impact, ...]
    timestep: float
    integrator: str
    mujoco_version: str
    missed_impacts: int = 0

    @property
    def total_energy(self) -> Array:
        """Potential plus kinetic energy of each sample [J], shape (n_samples,)."""
        total: Array = self.energy.sum(axis=1)
        return total

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the trajectory to a compressed .npz file (no pickle inside).

        Args:
            path: File to write; ".npz" is added if it has another ending.

        Returns:
            The path written.
        """
        target = Path(path)
        if target.suffix != ".npz":
            target = target.with_name(target.name + ".npz")
        numbers = np.array(
            [[getattr(impact, name) for name in _IMPACT_NUMBERS]
             for impact in self.impacts]
        ).reshape(len(self.impacts), len(_IMPACT_NUMBERS))  # fmt: skip
        geoms = np.array([impact.geoms for impact in self.impacts], dtype=np.str_)
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _ARRAYS}
        scalars: dict[str, Any] = {name: getattr(self, name) for name in _SCALARS}
        try:
            np.savez_compressed(
                target,
                layout_version=LAYOUT_VERSION,
                impact_numbers=numbers,
                impact_geoms=geoms.reshape(len(self.impacts), 2),
                **arrays,
                **scalars,
            )
        except OSError as error:
            msg = f"cannot write {target}: {error.strerror or error}"
            raise TrajectoryError(msg) from error
        return target

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trajectory:
        """Reads a trajectory written by `save`.

        Raises:
            TrajectoryError: If the file is missing, damaged or of another layout.
        """
        try:
            # opened here: NumPy leaves a file open that is no archive
            with (
                Path(path).open("rb") as stream,
                np.load(stream, allow_pickle=False) as file,
            ):
                return _from_arrays({name: file[name] for name in file.files})
        except FileNotFoundError as error:
            msg = f"there is no trajectory file {os.fspath(path)!r}"
            raise TrajectoryError(msg) from error
        except _DAMAGE as e:
            reason = " ".join(str(e).split()) or type(e).__name__
            msg = f"{os.fspath(path)!r} is not a trajectory file: {reason}"
            raise TrajectoryError(msg) from e


def _from_arrays(stored: dict[str, npt.NDArray[Any]]) -> Trajectory:
    """Returns the trajectory of the arrays of a file."""
    version = int(stored["layout_version"])
    if version not in (1, LAYOUT_VERSION):
        msg = f"layout version {version}, this package reads 1 and {LAYOUT_VERSION}"
        raise ValueError(msg)
    table = stored["impact_numbers"]
    if version == 1:
        # it knew of no other force than that of the waveform
        table = np.column_stack([table, table[:, _IMPACT_NUMBERS.index("height")]])
    impacts = tuple(
        Impact(
            geoms=(str(geoms[0]), str(geoms[1])),
            **dict(zip(_IMPACT_NUMBERS, map(float, numbers), strict=True)),
        )
        for geoms, numbers in zip(stored["impact_geoms"], table, strict=True)
    )
    return Trajectory(
        **{name: stored[name] for name in _ARRAYS},
        impacts=impacts,
        timestep=float(stored["timestep"]),
        integrator=str(stored["integrator"]),
        mujoco_version=str(stored["mujoco_version"]),
        missed_impacts=int(stored["missed_impacts"]),
    )
