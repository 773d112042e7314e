"""What needs MuJoCo Warp is skipped without it."""

from importlib.util import find_spec

import pytest

AVAILABLE = find_spec("mujoco_warp") is not None
NEED_IT = ["test_impacts.py", "test_flags.py", "test_support.py"]

collect_ignore = [] if AVAILABLE else NEED_IT


@pytest.fixture(scope="session", autouse=True)
def _quick_compiler():
    """Compiles kernels as they stand: optimising takes longer than running them."""
    if AVAILABLE:
        import warp

        warp.config.optimization_level = 0
        warp.config.log_level = warp.LOG_WARNING
