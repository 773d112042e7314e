// SPDX-License-Identifier: Apache-2.0
// What MuJoCo's solver does to the kinematic trees in a step.

#ifndef MUJOCO_IMPACT_ENGINE_HANDOVER_HOLD_H_
#define MUJOCO_IMPACT_ENGINE_HANDOVER_HOLD_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Nothing; carries it by contacts alone; holds it by other constraints as well.
enum class Hold { kNone, kCarried, kTied };

// Of each tree, by the constraints in `d` (ntree).
void FindHeld(const mjModel* m, const mjData* d, Hold* held);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_HANDOVER_HOLD_H_
