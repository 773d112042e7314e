// SPDX-License-Identifier: Apache-2.0

#include <mujoco/mujoco.h>

// A clock that stands still, for `mjcb_time`: src/mujoco_impact/still_clock.py says why.
extern "C" __attribute__((visibility("default"))) mjtNum mujoco_impact_still_clock() { return 0; }
