"""Impacts by artificial impulse waveforms for MuJoCo."""

from mujoco_impact._plugin import load as load
from mujoco_impact.runner import run as run
from mujoco_impact.scene import attach as attach
from mujoco_impact.trajectory import Impact as Impact
from mujoco_impact.trajectory import Trajectory as Trajectory
