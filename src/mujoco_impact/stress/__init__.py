"""Where does a scene of one's own stop being sound? `mujoco-impact stress MODEL`.

`stress_scene` runs it in many ways (`variations`), watches each run (`watched_run`)
and compares timesteps with the finest one (`differences`).
"""

from __future__ import annotations

from mujoco_impact.stress.findings import Finding, StressInterrupted, stress_scene

__all__ = ["Finding", "StressInterrupted", "stress_scene"]
