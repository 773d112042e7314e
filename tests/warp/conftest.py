"""What needs MuJoCo Warp is skipped without it."""

from importlib.util import find_spec

NEED_IT = ["test_warp_impacts.py", "test_flags.py", "test_support.py"]

collect_ignore = [] if find_spec("mujoco_warp") else NEED_IT
