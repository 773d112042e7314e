// SPDX-License-Identifier: Apache-2.0
// The impacts of a step, one after the other.
//
// Impacts that come at once, or in quick succession, are one problem of the law. Those further
// apart within the step are resolved in rounds: after each the bodies are moved to where it leaves
// them, and whatever closes next is resolved with the geometry of its own time.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_IMPACTS_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_IMPACTS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/deliver/flights.h"
#include "engine/path/mobility.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Resolves every impact of the step and adds what it exerts in it to `delivery`. New pulses are
// left pending in the state. `kick` is what pulses under way add to the velocity in the step (nv),
// null if none is. Returns the flights of tumbling bodies, whose impacts are no forces.
Flights ResolveImpacts(const mjModel* m, mjData* d, int instance, const Mobility& mobility,
                       const mjtNum* kick, State& state, Delivery& delivery, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_IMPACTS_H_
