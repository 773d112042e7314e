// SPDX-License-Identifier: Apache-2.0
// Where a pulse acts, and in which direction: it goes along with the bodies.

#ifndef MUJOCO_IMPACT_ENGINE_LINE_OF_ACTION_H_
#define MUJOCO_IMPACT_ENGINE_LINE_OF_ACTION_H_

#include <mujoco/mujoco.h>

#include "engine/state.h"
#include "engine/vector3.h"

namespace mujoco_impact::engine {

// The body of geom[side] of the pulse.
int BodyOf(const mjModel* m, const Pulse& pulse, int side);

// The line now: through the points of the bodies, along the line of centres of two spheres,
// otherwise along the normal at the onset.
LineOfAction LineNow(const mjModel* m, const mjData* d, const Pulse& pulse);

// Force of the pulse on its second body in this step, over its normal force.
inline Vector3 PulseDirection(const Pulse& pulse) {
  return Load(pulse.line_next.normal) + Load(pulse.tangent);
}

// Adds s Jᵀ of a pulse whose normal impulse is 1, over all degrees of freedom, as if it acted along
// `line`.
void AddPulseRow(const mjModel* m, const mjData* d, const Pulse& pulse, const LineOfAction& line,
                 mjtNum s, mjtNum* row);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_LINE_OF_ACTION_H_
