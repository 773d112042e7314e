"""What a run leaves behind: sampled states, energies and the impacts."""

from __future__ import annotations

import dataclasses
import importlib
import os
import stat
import struct
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from mujoco_impact.errors import MissingExtraError, TrajectoryError
from mujoco_impact.files import replacing
from mujoco_impact.impact import (
    COLUMNS,
    Impact,
    impact_columns,
    impacts_of,
    impacts_table,
    numbers_of,
)
from mujoco_impact.recordings import AnyArray, read_arrays
from mujoco_impact.remarks import NATIVE, NO_IMPACT, Remark

Array: TypeAlias = npt.NDArray[np.float64]

LAYOUT_VERSION = 3
"""Version of the .npz layout that `Trajectory.save` writes."""

_DAMAGE = (
    OSError,
    ValueError,
    KeyError,
    TypeError,
    EOFError,
    OverflowError,
    MemoryError,  # the parser of headers: nested too deeply
    RuntimeError,  # zipfile: encrypted, or NotImplementedError; RecursionError
    SyntaxError,  # numpy: the header of an array
    struct.error,
    tokenize.TokenError,  # numpy, too
    zipfile.BadZipFile,
    zlib.error,
)
"""What NumPy and zipfile raise, depending on which bytes are wrong."""

_ARRAYS = ("time", "qpos", "qvel", "energy")
_SCALARS = ("timestep", "integrator", "mujoco_version", "missed_impacts", "start")
_STORED = ("impact_numbers", "impact_geoms", "remarks", *_ARRAYS, *_SCALARS)
_TEXTS = ("integrator", "mujoco_version", "start", "impact_geoms", "remarks")
_KINDS = {"U": "text", "iu": "integers", "iuf": "numbers"}
"""Kinds of NumPy's types, and what a message calls them."""

MOST_IMPACTS = 4_000_000
"""Most impacts that are read of a file: each takes a kilobyte as an `Impact`."""


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """A simulated motion, sampled at constant intervals.

    Attributes:
        time: Time of each sample [s], shape (n_samples,).
        qpos: Generalized positions (joint units: [m], [rad], quaternions), shape
            (n_samples, nq).
        qvel: Generalized velocities [m/s, rad/s], shape (n_samples, nv).
        energy: Potential and kinetic energy as MuJoCo counts them, but without the
            weight of mocap bodies, which are moved by hand [J], shape (n_samples, 2).
        impacts: The impacts that began during the run, in order of time.
        timestep: Simulation timestep [s].
        integrator: Name of the integrator, for example "Euler".
        mujoco_version: Version of MuJoCo that made the run.
        missed_impacts: Impacts that began but whose record was overwritten before it
            could be read; 0 unless a warning was given.
        remarks: What deserves attention: missed impacts, energy from nowhere, no
            impact at all; empty if nothing does.
        start: What the run started from, such as "keyframe 'release'".
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
    remarks: tuple[Remark, ...] = ()
    start: str = ""

    def __repr__(self) -> str:
        """Returns what is in it, in one line."""
        return f"<Trajectory: {', '.join(self._facts())}>"

    def _repr_html_(self) -> str:
        """Returns what a notebook shows."""
        from mujoco_impact.report.notebook import trajectory_html

        return trajectory_html(self)

    def _facts(self) -> list[str]:
        """Returns what there is to know of it, in a few words each."""
        facts = [
            f"{self.time[-1]:g} s",
            f"{len(self.time)} samples",
            f"{self.qvel.shape[1]} degrees of freedom",
        ]
        kinds = [remark.kind for remark in self.remarks]
        if NATIVE in kinds:
            return [*facts, "MuJoCo's own contacts"]
        facts.append(f"{len(self.impacts)} impacts")
        return facts + [f"remark: {kind}" for kind in kinds if kind != NO_IMPACT]

    @property
    def total_energy(self) -> Array:
        """Potential plus kinetic energy of each sample [J], shape (n_samples,)."""
        total: Array = self.energy.sum(axis=1)
        return total

    def impacts_table(self) -> npt.NDArray[Any]:
        """Returns the impacts as a structured array, shape (n_impacts,).

        Its fields are `geom1`, `geom2` and the numbers of `Impact`; vectors have
        three components.
        """
        return impacts_table(self.impacts)

    def to_pandas(self) -> Any:
        """Returns the impacts as a `pandas.DataFrame`, one row each.

        Vectors are three columns, such as `position_x`.

        Raises:
            MissingExtraError: If pandas is not installed.
        """
        try:
            pandas = importlib.import_module("pandas")
        except ImportError as error:
            msg = "to_pandas needs pandas: run `pip install pandas`"
            raise MissingExtraError(msg) from error
        return pandas.DataFrame(impact_columns(self.impacts))

    def plot(self, path: str | os.PathLike[str] | None = None) -> Any:
        """Draws velocities, energies and impacts over time.

        Args:
            path: File to write the picture to, or None.

        Returns:
            A matplotlib figure; a notebook shows it.

        Raises:
            MissingExtraError: If matplotlib is not installed.
        """
        from mujoco_impact.plot.trajectory import plot_trajectory

        return plot_trajectory(self, path)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the trajectory to a compressed .npz file (no pickle inside).

        Args:
            path: File to write; ".npz" is added if it has another ending.

        Returns:
            The path written.
        """
        target = Path(path)
        if not target.name:
            raise TrajectoryError(f"cannot write {os.fspath(path)!r}: it names no file")
        if target.suffix != ".npz":
            target = target.with_name(target.name + ".npz")
        geoms = np.array([impact.geoms for impact in self.impacts], dtype=np.str_)
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _ARRAYS}
        scalars: dict[str, Any] = {name: getattr(self, name) for name in _SCALARS}
        try:
            with replacing(target) as part:
                np.savez_compressed(
                    part,
                    layout_version=LAYOUT_VERSION,
                    impact_numbers=numbers_of(self.impacts),
                    impact_geoms=geoms.reshape(len(self.impacts), 2),
                    remarks=_remark_texts(self.remarks),
                    **arrays,
                    **scalars,
                )
        except OSError as error:
            msg = f"cannot write {target}: {error.strerror or error}"
            raise TrajectoryError(msg) from error
        return target

    def render(
        self,
        model: Any,
        path: str | os.PathLike[str],
        *,
        caption: str = "",
        speed: float = 1.0,
        camera: str | int | None = None,
        size: tuple[int, int] = (640, 480),
        fps: int = 25,
        arrows: bool = True,
        keyframe: str | int | None = None,
        at: float | None = None,
    ) -> Path:
        """Writes a video of the motion, without a display (extra `video`).

        Args:
            model: The model that was run: an MjModel, a specification, path or XML
                text. A scene that is not compiled gets a sky and a light if it has
                none, where MuJoCo shows black.
            path: File to write: .mp4, .gif, .webp, or .png for one picture.
            caption: Text above.
            speed: Simulated seconds in a second of video; below 1 is slow motion.
            camera: Name or number of a camera of the model. None: its first one that
                stands still, else one that sees all that moves.
            size: Width and height [pixels], without caption and footer.
            fps: Pictures per second of video.
            arrows: Whether impulses are drawn as arrows.
            keyframe: Keyframe that the run started from: mocap bodies, which are not
                recorded, stand where it has them.
            at: Time of a .png [s]; by default that of the first impact, or the end.

        Returns:
            The path written.

        Raises:
            RenderingError: If this machine has no OpenGL, neither EGL nor OSMesa.
            MissingExtraError: If a library is missing.
            ConfigError: If a number or the ending of the path is not valid.
            SceneError: If the model or the camera is not valid.
        """
        from mujoco_impact import video

        view = video.View(speed=speed, camera=camera, size=size, fps=fps, arrows=arrows)
        panels = [video.Panel.of(self, caption)]
        return video.write_video(
            model, panels, path, view=view, keyframe=keyframe, at=at
        )

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trajectory:
        """Reads a trajectory written by `save`.

        Raises:
            TrajectoryError: If the file is missing, damaged, of another layout, or
                larger than a run may be (`limits.LARGEST_RECORDING`).
        """
        try:
            with Path(path).open("rb") as stream:
                if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
                    raise ValueError("it is a device or a pipe")
                _check_version(read_arrays(stream, ["layout_version"]))
                return _from_arrays(read_arrays(stream, _STORED))
        except FileNotFoundError as error:
            msg = f"there is no trajectory file {os.fspath(path)!r}"
            raise TrajectoryError(msg) from error
        except _DAMAGE as e:
            reason = " ".join(str(e).split()) or type(e).__name__
            msg = f"{os.fspath(path)!r} is not a trajectory file: {reason}"
            raise TrajectoryError(msg) from e


def _check_version(stored: dict[str, AnyArray]) -> None:
    """Raises ValueError if a file is of another layout."""
    version = stored["layout_version"]
    if version.shape != () or version.dtype.kind not in "iu":
        raise ValueError("its layout version is no number")
    if version != LAYOUT_VERSION:
        msg = f"layout version {version}, this package reads {LAYOUT_VERSION}"
        raise ValueError(msg)


def _from_arrays(stored: dict[str, AnyArray]) -> Trajectory:
    """Returns the trajectory of the arrays of a file; ValueError if it is none."""
    _check_shapes(stored)
    return Trajectory(
        **{name: np.asarray(stored[name], dtype=np.float64) for name in _ARRAYS},
        impacts=impacts_of(stored["impact_numbers"], stored["impact_geoms"]),
        timestep=float(stored["timestep"]),
        integrator=str(stored["integrator"]),
        mujoco_version=str(stored["mujoco_version"]),
        missed_impacts=int(stored["missed_impacts"]),
        start=str(stored["start"]),
        remarks=tuple(Remark(str(kind), str(text)) for kind, text in stored["remarks"]),
    )


def _check_shapes(stored: dict[str, AnyArray]) -> None:
    """Raises ValueError if arrays are not of numbers, or do not fit each other."""
    samples, impacts = stored["time"].size, len(np.atleast_1d(stored["impact_numbers"]))
    if not samples or impacts > MOST_IMPACTS:
        msg = f"{samples} samples and {impacts} impacts; allowed: 1 or more samples"
        raise ValueError(f"{msg}, {MOST_IMPACTS} impacts")
    # None: any number of columns
    shapes = {
        "time": (samples,),
        "qpos": (samples, None),
        "qvel": (samples, None),
        "energy": (samples, 2),
        "impact_numbers": (impacts, COLUMNS),
        "impact_geoms": (impacts, 2),
        "remarks": (None, 2),
        **dict.fromkeys(_SCALARS, ()),
    }
    for name, shape in shapes.items():
        array = stored[name]
        fits = len(array.shape) == len(shape) and all(
            wanted in (None, size)
            for size, wanted in zip(array.shape, shape, strict=True)
        )
        numbers = "iu" if name == "missed_impacts" else "iuf"
        kinds = "U" if name in _TEXTS else numbers
        if not fits or array.dtype.kind not in kinds:
            wanted_shape = str(shape).replace("None", "n")
            msg = (
                f"array {name!r} has shape {array.shape} of {array.dtype}, "
                f"needed: {wanted_shape} of {_KINDS[kinds]}"
            )
            raise ValueError(msg)


def _remark_texts(remarks: tuple[Remark, ...]) -> npt.NDArray[np.str_]:
    """Returns kind and text of remarks as an array, shape (n, 2)."""
    texts = [(remark.kind, remark.text) for remark in remarks]
    return np.array(texts, dtype=np.str_).reshape(len(texts), 2)
