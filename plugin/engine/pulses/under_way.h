// SPDX-License-Identifier: Apache-2.0
// Pulses that outlast a step: what those under way exert in this one.

#ifndef MUJOCO_IMPACT_ENGINE_PULSES_UNDER_WAY_H_
#define MUJOCO_IMPACT_ENGINE_PULSES_UNDER_WAY_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/path/mobility.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Adds the pulses under way and notes what they will have delivered.
void DeliverActive(const mjModel* m, mjData* d, const Mobility& mobility, State& state,
                   Delivery& delivery, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PULSES_UNDER_WAY_H_
