// SPDX-License-Identifier: Apache-2.0
// Where a pulse acts, and in which direction: it goes along with the bodies.

#ifndef MUJOCO_IMPACT_ENGINE_PULSES_LINE_OF_ACTION_H_
#define MUJOCO_IMPACT_ENGINE_PULSES_LINE_OF_ACTION_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// The line now: through the points of the bodies, along the line of centres of two spheres,
// otherwise along the normal at the onset.
LineOfAction LineNow(const mjModel* m, const mjData* d, const Pulse& pulse);

// Adds s Jᵀ of a pulse whose normal impulse is 1, over all degrees of freedom, as if it acted along
// `line`.
void AddPulseRow(const mjModel* m, const mjData* d, const Pulse& pulse, const LineOfAction& line,
                 mjtNum s, mjtNum* row);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PULSES_LINE_OF_ACTION_H_
