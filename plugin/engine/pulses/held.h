// SPDX-License-Identifier: Apache-2.0
// Stops that hold against pulses that outlast a step (path/stops.h), found anew in every step.

#ifndef MUJOCO_IMPACT_ENGINE_PULSES_HELD_H_
#define MUJOCO_IMPACT_ENGINE_PULSES_HELD_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/path/mobility.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// The ties and the stops that hold against what the pulses under way have yet to deliver.
Mobility HeldNow(const mjModel* m, mjData* d, const Mobility& ties, State& state, Scratch& scratch);

// The same after this step, new pulses included.
Mobility HeldAfter(const mjModel* m, mjData* d, const Mobility& ties, State& state,
                   Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PULSES_HELD_H_
