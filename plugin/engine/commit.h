// SPDX-License-Identifier: Apache-2.0
// The end of a step: what compute left pending becomes state.

#ifndef MUJOCO_IMPACT_ENGINE_COMMIT_H_
#define MUJOCO_IMPACT_ENGINE_COMMIT_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Called once per step after the integration: corrects the position, commits the pulses.
void CommitStep(const mjModel* m, mjData* d, int instance);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_COMMIT_H_
