// SPDX-License-Identifier: Apache-2.0
// What the elements of a tuple may say of materials.
//
// A geom has one material, whatever the order of elements and instances: a tuple names it once, and
// no instance says of a geom that another owns what that one does not say.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_ASSIGNMENT_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_ASSIGNMENT_H_

#include <mujoco/mujoco.h>

#include "engine/scene/config.h"

namespace mujoco_impact::engine {

// What is wrong with the elements of the tuple of `instance`; empty if nothing is.
ConfigError CheckAssignment(const mjModel* m, int instance, const Config& config);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_ASSIGNMENT_H_
