// SPDX-License-Identifier: Apache-2.0

#include <mujoco/mjplugin.h>

#include "engine/plugin.h"

mjPLUGIN_LIB_INIT(mujoco_impact) { mujoco_impact::engine::RegisterPlugin(); }

// A clock that stands still, for `mjcb_time`: src/mujoco_impact/still_clock.py says why.
extern "C" __attribute__((visibility("default"))) mjtNum mujoco_impact_still_clock() { return 0; }
