// SPDX-License-Identifier: Apache-2.0
// The memory that a step with impacts takes. MuJoCo ends the process when the stack of mjData
// overflows, so a step asks first.

#ifndef MUJOCO_IMPACT_ENGINE_FORESEE_STEP_MEMORY_H_
#define MUJOCO_IMPACT_ENGINE_FORESEE_STEP_MEMORY_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"

namespace mujoco_impact::engine {

// Whether mjData has room for a step with impacts besides what its islands ask for themselves.
bool StepFits(const mjModel* m, const mjData* d, const Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_FORESEE_STEP_MEMORY_H_
