// SPDX-License-Identifier: Apache-2.0
// How stiff the bodies of a contact are against each other, by their shapes and the material.

#ifndef MUJOCO_IMPACT_ENGINE_CONTACT_STIFFNESS_H_
#define MUJOCO_IMPACT_ENGINE_CONTACT_STIFFNESS_H_

#include <mujoco/mujoco.h>

#include "engine/config.h"

namespace mujoco_impact::engine {

// 1/R₁ + 1/R₂ where the bodies touch [1/m].
mjtNum ContactCurvature(const mjModel* m, const mjContact& contact);

// Hertz stiffness K [N/m^1.5].
mjtNum ContactStiffness(const mjModel* m, const Config& config, const mjContact& contact);

// How long two bodies touch that close with `speed`, by the masses of the bodies alone [s].
mjtNum EstimateContactTime(const mjModel* m, const Config& config, const mjContact& contact,
                           mjtNum speed);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_CONTACT_STIFFNESS_H_
