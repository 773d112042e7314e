"""The benchmark of run time against error: what `mujoco-impact bench` runs.

`scenes` says what is simulated, `methods` how, `truths` what is right; `measure` makes
points (run time, error) of them, `store` and `charts` keep them.
"""
