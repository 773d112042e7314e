"""What only the project runs: it is in a clone, and not in the wheel.

`bench` is the benchmark against other engines and MuJoCo's own contacts, `stress` the
random scenes, `domains` whole domains of dm_control and gymnasium, `coverage` how often
the intervals of a calibration hold the truth. The scripts of the project run them:
``python -m mujoco_impact_lab COMMAND``.
"""
