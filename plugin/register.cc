// SPDX-License-Identifier: Apache-2.0

#include <mujoco/mjplugin.h>

#include "engine/plugin.h"

mjPLUGIN_LIB_INIT(mujoco_impact) { mujoco_impact::engine::RegisterPlugin(); }
