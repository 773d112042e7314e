"""Calibration of the law `calibrated` on measured shots, after Dondo and Noborio 2.5.

`calibrate` finds the parameters, `synthetic_shots` makes shots whose truth is known,
`read_shots` and `write_shots` are their files.
"""

from mujoco_impact.calibration.fit import FOLDS, Calibration, calibrate
from mujoco_impact.calibration.identifiability import Identifiability, Interval, Range
from mujoco_impact.calibration.objective import DEFAULT_KAPPA, DEFAULT_W0
from mujoco_impact.calibration.parameters import (
    Parameters,
    read_parameters,
    write_parameters,
)
from mujoco_impact.calibration.shots import Shots
from mujoco_impact.calibration.shots_file import read_shots, write_shots
from mujoco_impact.calibration.synthetic import (
    Camera,
    Truth,
    hertz_truth,
    synthetic_shots,
)

__all__ = [
    "DEFAULT_KAPPA",
    "DEFAULT_W0",
    "FOLDS",
    "Calibration",
    "Camera",
    "Identifiability",
    "Interval",
    "Parameters",
    "Range",
    "Shots",
    "Truth",
    "calibrate",
    "hertz_truth",
    "read_parameters",
    "read_shots",
    "synthetic_shots",
    "write_parameters",
    "write_shots",
]
