"""Environments are tested without a window."""

import os

# before dm_control is imported, which looks for OpenGL then
os.environ.setdefault("MUJOCO_GL", "disable")
