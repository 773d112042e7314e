"""Watching a run, so that nothing goes wrong in it without a word.

`watch` looks at every step, some hundred of them at a time (`step_log`): at bodies too
fast for their gap (`fast_bodies`), bodies that pass through each other (`overlaps`),
and energy from nowhere (`energy_balance`, `free_flight`). `encounters` says which geoms
can meet, `mocap_bodies` what is moved by hand.
"""

from mujoco_impact.verdict.watch import ALONE, RunWatch, quiet_samples

__all__ = ["ALONE", "RunWatch", "quiet_samples"]
