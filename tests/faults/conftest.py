"""A simulation in the middle of a pulse, for every fault."""

from __future__ import annotations

import mujoco
import pytest
from pulse_scenes import in_mid_pulse, row


@pytest.fixture
def mid_pulse() -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = row().compile()
    return model, in_mid_pulse(model)
