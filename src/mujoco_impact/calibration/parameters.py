"""The parameters of the calibrated law, and their file."""

from __future__ import annotations

import dataclasses
import json
import math
import os
from pathlib import Path
from typing import Any

from mujoco_impact.calibration.objective import DEFAULT_KAPPA, DEFAULT_W0
from mujoco_impact.errors import ConfigError
from mujoco_impact.files import quoted, read_text, write_text

FORMAT = "mujoco-impact parameters 1"
"""What `format` says in a file of parameters."""


@dataclasses.dataclass(frozen=True)
class Parameters:
    """Parameters of Dondo and Noborio, with the units that they need.

    Attributes:
        sh: S_h of equation (6) [N s/(kg m)].
        sw: S_w of equation (6).
        e: E, the restitution of the waveform.
        mu_s: Static friction factor of equation (7).
        mu_d: Dynamic friction factor of equation (9).
        alpha: alpha_k, one per contact.
        w0: W_0 of equation (6) [s].
        kappa: Factor that gives S_w/p the unit ms.
    """

    sh: float
    sw: float
    e: float
    mu_s: float
    mu_d: float
    alpha: tuple[float, ...]
    w0: float = DEFAULT_W0
    kappa: float = DEFAULT_KAPPA

    @property
    def settings(self) -> dict[str, Any]:
        """Settings for `attach(scene, law="calibrated", **settings)`."""
        return {
            "sh": self.sh,
            "sw": self.sw,
            "e": self.e,
            "alpha": self.alpha,
            "w0": self.w0,
            "kappa": self.kappa,
        }

    @property
    def friction(self) -> dict[str, Any]:
        """Settings for `attach` that switch friction on, equations (7)-(9)."""
        return {"friction": "paper", "mu_s": self.mu_s, "mu_d": self.mu_d}


def write_parameters(
    parameters: Parameters, path: str | os.PathLike[str], **report: Any
) -> Path:
    """Writes parameters as JSON.

    Args:
        parameters: What to write.
        path: File to write.
        **report: What else the file should tell; not read back.

    Returns:
        The path written.
    """
    document = {
        "format": FORMAT,
        "parameters": dataclasses.asdict(parameters),
        **report,
    }
    target = Path(path)
    text = json.dumps(document, indent=2, allow_nan=False)
    write_text(target, text + "\n")
    return target


def read_parameters(path: str | os.PathLike[str]) -> Parameters:
    """Reads parameters written by `write_parameters`.

    Raises:
        ConfigError: If the file is missing, is none of parameters, or lacks one.
    """
    text = read_text(path, what="parameters", error=ConfigError)
    try:
        # as numbers of Python, integers of any length would take any time
        document = json.loads(text, object_pairs_hook=_object, parse_int=float)
    except (ValueError, RecursionError) as error:
        msg = f"cannot read parameters from {os.fspath(path)}: {error}"
        raise ConfigError(msg) from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        msg = f"{os.fspath(path)} is not a file of parameters: no 'format': {FORMAT!r}"
        raise ConfigError(msg)
    return _checked(os.fspath(path), document.get("parameters"))


def _checked(path: str, given: Any) -> Parameters:
    """Returns the parameters of a document; ranges are checked by the plugin."""
    fields = {field.name for field in dataclasses.fields(Parameters)}
    if not isinstance(given, dict) or given.keys() != fields:
        msg = f"{path}: 'parameters' needs {', '.join(sorted(fields))} and nothing else"
        raise ConfigError(msg)
    alpha = given["alpha"]
    if not (isinstance(alpha, list) and alpha and all(map(_is_number, alpha))):
        msg = f"{path}: alpha = {quoted(alpha)}; allowed: a list of finite numbers"
        raise ConfigError(msg)
    for name in fields - {"alpha"}:
        if not _is_number(given[name]):
            msg = f"{path}: {name} = {quoted(given[name])}; allowed: a finite number"
            raise ConfigError(msg)
    return Parameters(**{**given, "alpha": tuple(alpha)})


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Returns an object of a JSON file; ValueError if a key is there twice."""
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"{quoted(name)} is there twice")
        found[name] = value
    return found


def _is_number(value: Any) -> bool:
    """Whether a value is a finite number; integers are read as float."""
    return isinstance(value, float) and math.isfinite(value)
