"""`python -m mujoco_impact` is the command `mujoco-impact`."""

from mujoco_impact.cli import main

if __name__ == "__main__":
    main()
