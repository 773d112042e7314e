// SPDX-License-Identifier: Apache-2.0
// Arrows for the forces of impacts, where MuJoCo draws those of its own contacts.

#ifndef MUJOCO_IMPACT_ENGINE_RECORD_VISUALIZE_H_
#define MUJOCO_IMPACT_ENGINE_RECORD_VISUALIZE_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Adds an arrow for each pulse that acts in this step, if contact forces are shown.
void DrawPulses(const mjModel* m, mjData* d, const mjvOption* option, mjvScene* scene,
                int instance);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RECORD_VISUALIZE_H_
